"""The planned phases of actors, compared with their measured motion. Frames, metres, seconds, radians."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agents.protocol.judging.measured_motion import path_request
from agents.protocol.rule import NotApplicable

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from agents.plan.motion import MotionPhase
    from agents.protocol.judging.measured_motion import MeasuredMotion
    from agents.protocol.measures.motion import MotionPathRequest
    from agents.protocol.rule import RuleContext

RESTING = frozenset({"hold", "settle"})
# Motions that gravity may drive: the actor gets as fast as in a fall over the same distance.
_DRIVEN_BY_GRAVITY = frozenset(
    {"fall", "slide", "roll", "topple", "swing", "bounce", "flow", "emit", "settle"}
)
_MIN_STEPS = 3  # of a motion; a shorter one is a twitch
_SLOW_SHARE = 0.25  # share of a planned mean speed that counts as moving, however slow that is
_MEAN_RADIUS = 0.25  # mean distance of points from the axis of a rotation, as a share of the actor's size


@dataclass(frozen=True, slots=True)
class Onset:
    """The frame from which an actor moves. ``carried``: it was moving already in the phase before."""

    frame: int
    carried: bool = False


def planned_phases(context: RuleContext, *kinds: str) -> Iterator[tuple[int, MotionPhase]]:
    """(index in the plan, phase) of some kinds, or all. Raises NotApplicable if the plan has none."""
    phases = context.planned.motion.phases
    if not any(not kinds or phase.kind in kinds for phase in phases):
        raise NotApplicable(f"the plan has no {' or '.join(kinds)}" if kinds else "the plan has no motion")
    for place, phase in enumerate(phases):
        if not kinds or phase.kind in kinds:
            yield place, phase


def phase_label(place: int, phase: MotionPhase) -> str:
    """The start of a finding about a phase: its path in the plan, its name, and its actor."""
    return f"motion.phases[{place}] ({phase.name!r}): {phase.actor!r}"


def phases_of(context: RuleContext, actor: str) -> list[MotionPhase]:
    """The phases of an actor, in order of time."""
    return sorted(
        (phase for phase in context.planned.motion.phases if phase.actor == actor),
        key=lambda phase: (phase.start, phase.end),
    )


def path_requests(context: RuleContext, *kinds: str) -> Iterator[MotionPathRequest]:
    """The requests for the motions of all actors of phases of some kinds, or of all phases."""
    for _, phase in planned_phases(context, *kinds):
        if request := path_request(context, phase.actor):
            yield request


def rest_speed(context: RuleContext, motion: MeasuredMotion) -> float:
    """The speed up to which an actor is at rest, in m/s."""
    return context.tolerances.rest_speed * max(1.0, motion.path.size)


def rest_start(phase: MotionPhase, fps: float) -> int:
    """The frame from which a ``settle`` phase must be at rest: its last second, or its last quarter if shorter."""
    return phase.end - max(1, round(min(fps, (phase.end - phase.start) / 4)))


def cause_of(context: RuleContext, phase: MotionPhase) -> MotionPhase | None:
    """The phase that causes another one; None if the plan has none."""
    return next((other for other in context.planned.motion.phases if other.name == phase.cause), None)


def onset_tolerance(context: RuleContext, phase: MotionPhase) -> float:
    """How many frames early or late a phase may start."""
    return max(context.tolerances.onset, context.tolerances.onset_share * (phase.end - phase.start))


def onset_window(context: RuleContext, phase: MotionPhase) -> float:
    """How many frames early or late a phase may start; nobody can plan to the frame when another phase sets it off."""
    most = onset_tolerance(context, phase)
    cause = cause_of(context, phase)
    if cause is None or cause.actor == phase.actor:
        return most
    return max(most, context.tolerances.onset_caused * (cause.end - cause.start))


def moving_speed(context: RuleContext, motion: MeasuredMotion, phase: MotionPhase) -> float:
    """The speed from which an actor counts as moving in a phase, in m/s.

    It is a share of the actor's top speed in the phase, but more than rest; less only where the plan is slower.
    """
    speeds = motion.speeds(phase.start, phase.end)
    speeds = speeds[np.isfinite(speeds)]
    peak = float(speeds.max()) if len(speeds) else 0.0
    seconds = max(1, phase.end - phase.start) / motion.fps
    planned = [distance for distance in (phase.extent, phase.amplitude) if distance]
    if phase.turn:
        planned.append(math.radians(abs(phase.turn)) * _MEAN_RADIUS * motion.path.size)
    floor = min([rest_speed(context, motion), *(_SLOW_SHARE * distance / seconds for distance in planned)])
    return max(context.tolerances.moving_share * peak, floor)


def find_onset(context: RuleContext, motion: MeasuredMotion, phase: MotionPhase) -> Onset | None:
    """When the actor starts the motion of a phase; None if it does not move in it.

    The search goes back as far as no other phase is planned to move the actor.
    """
    first, carried = _search_start(context, motion, phase)
    speeds = motion.speeds(first, phase.end)
    moving = speeds > moving_speed(context, motion, phase)
    moving[1:-1] |= moving[:-2] & moving[2:]  # a moment of rest, as at the top of a bounce
    for begin, stop in _runs(moving):
        lasts = stop - begin >= _MIN_STEPS or stop == len(moving)
        if lasts and first + stop > phase.start:
            if carried and begin == 0:
                return Onset(max(first, phase.start), carried=True)
            return Onset(first + begin)
    return None


def _search_start(context: RuleContext, motion: MeasuredMotion, phase: MotionPhase) -> tuple[int, bool]:
    """(frame from which the actor must be at rest before a phase, whether it may be moving there)."""
    earlier = [other for other in phases_of(context, phase.actor) if other.start < phase.start]
    if not earlier:
        return motion.start, False
    last = max(earlier, key=lambda other: other.end)
    if last.kind == "hold":
        return last.start, False
    if last.kind == "settle":
        return min(rest_start(last, motion.fps), phase.start), False
    return min(last.end, phase.start), True


def _runs(flags: npt.NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """(begin, end) of each run of set flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def actual_span(context: RuleContext, motion: MeasuredMotion, phase: MotionPhase) -> tuple[int, int]:
    """The first and last frame of a phase as measured; a phase that starts a little early or late is not cut off."""
    onset = find_onset(context, motion, phase)
    if onset is None or onset.carried:
        return phase.start, phase.end
    shift = onset.frame - phase.start
    if abs(shift) > onset_window(context, phase):
        return phase.start, phase.end
    later = [
        other.start
        for other in phases_of(context, phase.actor)
        if other.start >= phase.end and other is not phase
    ]
    return phase.start + min(shift, 0), min([phase.end + max(shift, 0), motion.end, *later])


def greatest_speed(context: RuleContext, phase: MotionPhase) -> float | None:
    """The top speed that is planned for a phase, in m/s; None if it is unknown.

    It is the planned one; or that of a fall over the planned extent; or twice the mean speed, as for an even
    acceleration. If gravity drives the motion and no extent is planned: that of a fall as long as the phase.
    """
    if phase.top_speed is not None:
        return phase.top_speed
    seconds = max(1, phase.end - phase.start) / context.facts.fps
    gravity = gravity_of(context)
    driven = phase.kind in _DRIVEN_BY_GRAVITY
    distances = [distance for distance in (phase.extent, phase.amplitude) if distance is not None]
    if not distances:
        return gravity * seconds if driven else None
    even = 2 * max(distances) / seconds
    return max(even, math.sqrt(2 * gravity * max(distances))) if driven else even


def gravity_of(context: RuleContext) -> float:
    """The acceleration of a fall, in m/s²: the scene's, or the earth's if the scene has none."""
    return float(np.linalg.norm(context.facts.gravity)) or 9.81
