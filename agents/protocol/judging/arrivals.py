"""When the actor of a cause arrives at what it sets in motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.measured_motion import mesh_names
from agents.protocol.judging.phases import cause_of, phases_of
from agents.protocol.judging.sizes import contact_gap
from agents.protocol.measures.motion import ContactFramesRequest
from agents.protocol.measures.requests import Unmeasured

if TYPE_CHECKING:
    from agents.plan.motion import MotionPhase
    from agents.protocol.measures.requests import Measures
    from agents.protocol.rule import RuleContext


def meeting(context: RuleContext, effect: MotionPhase, cause: MotionPhase) -> ContactFramesRequest | None:
    """The request for when the actors of cause and effect first touch; None where they cannot."""
    a, b = mesh_names(context, cause.actor), mesh_names(context, effect.actor)
    if effect.actor == cause.actor or not a or not b:
        return None
    return ContactFramesRequest(a, b, cause.start, effect.end, contact_gap(context, a, b), once=True)


def caused_after(context: RuleContext, phase: MotionPhase) -> MotionPhase | None:
    """The phase that ends the rest of an actor, if something else causes it."""
    later = (other for other in phases_of(context, phase.actor) if other.start >= phase.end)
    following = next((other for other in later if other is not phase), None)
    return following if following is not None and cause_of(context, following) is not None else None


def arrival_request(context: RuleContext, effect: MotionPhase) -> ContactFramesRequest | None:
    """The request for when the cause of a phase arrives at its actor; None where it cannot."""
    cause = cause_of(context, effect)
    return meeting(context, effect, cause) if cause is not None else None


def arrival(context: RuleContext, measures: Measures, effect: MotionPhase) -> tuple[str, int] | None:
    """The actor of a phase's cause, and the frame at which it arrives; None if that is not known.

    What touches when the cause begins may have touched long before.
    """
    cause, request = cause_of(context, effect), arrival_request(context, effect)
    if cause is None or request is None:
        return None
    try:
        frames = measures[request].frames
    except Unmeasured:
        return None
    return (cause.actor, frames[0]) if frames and frames[0] > cause.start else None


def arrive_at(actor: str, frame: int) -> str:
    """What to do about a cause that arrives at another frame than the planned one."""
    return (
        f"Let {actor!r} arrive at frame {frame}, by its start, speed or distance, and bake again; or plan its effect "
        "for when it arrives."
    )
