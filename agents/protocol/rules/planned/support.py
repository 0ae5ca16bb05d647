"""R5 and R6: what rests on something, and what leans against it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from agents.plan.relations import Aperture, EmbeddedIn, FixedAttachment, Inside, StableAgainst, SupportedBy
from agents.protocol.judging.geometry.balance import balance
from agents.protocol.judging.move_advice import describe_move, gap_vector, is_near
from agents.protocol.judging.planned_relations import (
    Violation,
    relation_rule,
    relations_of,
    surface_pair,
    surfaces,
)
from agents.protocol.judging.sizes import contact_gap, smallest_dimension
from agents.protocol.judging.solver_advice import into_collider
from agents.protocol.measures.contact import DepthRequest, FlushRequest, SupportRequest
from agents.protocol.measures.geometry import GapRequest
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from agents.protocol.facts import Vector
    from agents.protocol.measures.requests import Measures, Request
    from agents.protocol.rule import RuleContext

_BESIDE_LINE = 1e-4  # metres that a centre of mass may be beside a line or point of support
_NO_AREA = 1e-8  # m²; a smaller support area is a line or a point


def _too_deep(
    context: RuleContext, measures: Measures, request: DepthRequest, names: tuple[str, str], epsilon: float
) -> Violation | None:
    """The violation of a child that is deeper in its parents than it may be above them."""
    measured = measures[request]
    most = max(epsilon, context.tolerances.noise(smallest_dimension(context, request.a, request.b)))
    if measured.depth <= most:
        return None
    sentence = f"{names[0]!r} is {_mm(measured.depth)} deep in {names[1]}."
    if request.frame is not None and (advice := into_collider(context, names[0])):
        fix = advice  # where a simulation or keyframes have put it, a move is undone by the next bake
    elif is_near(context, request.a, measured.depth):
        fix = f"Move {names[0]!r} out by {_mm(measured.depth)}, so that the surfaces meet."
    else:
        fix = f"See why {names[0]!r} is inside {names[1]}: one of them is misplaced, or a hollow of it is closed."
    return Violation(sentence, measured.depth, most, "m", measured.at, fix)


def _mm(length: float) -> str:
    return f"{length * 1000:.1f} mm"


# R5: resting on


def _supports(context: RuleContext, child: str) -> Iterator[SupportedBy]:
    """All relations of a child with what supports it; each may give a part of the support."""
    return (relation for _, relation in relations_of(context, SupportedBy) if relation.child == child)


def _leans(context: RuleContext, child: str) -> Iterator[StableAgainst]:
    return (relation for _, relation in relations_of(context, StableAgainst) if relation.child == child)


def _is_held(context: RuleContext, child: str, *kinds: type[Any]) -> bool:
    """Whether a relation of these kinds keeps a child from tipping over."""
    return any(relation.nodes[0] == child for _, relation in relations_of(context, *kinds))


def _support(context: RuleContext, relation: SupportedBy, frame: int | None) -> SupportRequest:
    child = surfaces(context, relation.child)
    parents = surfaces(context, *relation.parents, but=child)
    # A leaning child stands on an edge: its underside is not opposed to its parents.
    opposed = 0.0 if any(_leans(context, relation.child)) else context.tolerances.opposed
    return SupportRequest(child, parents, contact_gap(context, child, parents), opposed, frame)


def _support_requests(
    context: RuleContext, relation: SupportedBy, frame: int | None
) -> Iterator[Request[Any]]:
    support = _support(context, relation, frame)
    yield support
    yield DepthRequest(support.child, support.parents, frame)
    yield from (_flush(context, lean, frame) for lean in _leans(context, relation.child))


def _not_resting(
    context: RuleContext, measures: Measures, relation: SupportedBy, frame: int | None
) -> Iterator[Violation]:
    request = _support(context, relation, frame)
    child, parents = relation.child, " and ".join(map(repr, relation.parents))
    if not _is_held(context, child, EmbeddedIn):
        depth = DepthRequest(request.child, request.parents, frame)
        if too_deep := _too_deep(context, measures, depth, (child, parents), request.within):
            yield too_deep
            return
    support = measures[request]
    if support.opposed is None:
        floating = _floating(child, parents, support.clearance, support.at, request.within)
        is_far = support.clearance is not None and not is_near(context, request.child, support.clearance)
        yield replace(floating, fix=None) if is_far else floating
        return
    if _is_held(context, child, FixedAttachment, Aperture, EmbeddedIn, Inside):
        return
    if support.opposed > request.opposed:
        turn = math.degrees(math.acos(max(-1.0, min(1.0, -support.opposed))))
        yield Violation(
            f"{child!r} stands on an edge: its face on {parents} is tilted by {turn:.1f}°.",
            support.opposed,
            request.opposed,
            "",
            support.at,
            "Turn it until its underside lies flat on its parents.",
        )
        return
    yield from _unbalanced(context, measures, relation, frame)


def _floating(child: str, parents: str, clearance: float | None, at: Vector | None, most: float) -> Violation:
    if clearance is None:
        return Violation(f"{child!r} has nothing of {parents} below it.", None, most, "m", at)
    if clearance > most:
        sentence = f"{child!r} floats {_mm(clearance)} above {parents}."
        return Violation(sentence, clearance, most, "m", at, f"Move {child!r} {_mm(clearance)} down (−Z).")
    return Violation(f"{child!r} touches {parents}, but no part of it lies on top.", None, most, "m", at)


def _unbalanced(
    context: RuleContext, measures: Measures, relation: SupportedBy, frame: int | None
) -> Iterator[Violation]:
    bearing = [
        place
        for support in _supports(context, relation.child)
        if surfaces(context, *support.parents, but=surfaces(context, support.child))
        for place in measures[_support(context, support, frame)].bearing
    ]
    for lean in _leans(context, relation.child):
        bearing += measures[_flush(context, lean, frame)].touching
    centre = measures[_support(context, relation, frame)].centre
    margin, area = balance(bearing, centre)
    least = context.tolerances.balance_share * math.sqrt(area) if area > _NO_AREA else -_BESIDE_LINE
    if margin >= least:
        return
    where = f"{_mm(-margin)} outside" if margin < 0 else f"only {_mm(margin)} inside"
    yield Violation(
        f"{relation.child!r} tips over: its centre of mass is {where} its support area{_wanted(least)}.",
        margin,
        least,
        "m",
        centre,
        "Move it over its parents, widen its base, or turn it upright.",
    )


def _wanted(margin: float) -> str:
    """How far inside a centre of mass has to be, as the rest of a sentence; nothing for what stands on a line."""
    return f", and should be at least {_mm(margin)} inside" if margin > 0 else ""


# R6: leaning against


def _flush(context: RuleContext, relation: StableAgainst, frame: int | None) -> FlushRequest:
    child, parent = surface_pair(context, relation.child, relation.parent)
    # A cupboard that stands on a room's floor against the room's wall must be checked at the wall.
    sideways = any(relation.parent in support.parents for support in _supports(context, relation.child))
    return FlushRequest(child, parent, contact_gap(context, child, parent), sideways, frame)


def _flush_requests(
    context: RuleContext, relation: StableAgainst, frame: int | None
) -> Iterator[Request[Any]]:
    flush = _flush(context, relation, frame)
    yield flush
    yield GapRequest(flush.child, flush.parent, frame)
    yield DepthRequest(flush.child, flush.parent, frame)


def _not_leaning(
    context: RuleContext, measures: Measures, relation: StableAgainst, frame: int | None
) -> Iterator[Violation]:
    request, tolerances = _flush(context, relation, frame), context.tolerances
    child, parent = relation.child, relation.parent
    depth = DepthRequest(request.child, request.parent, frame)
    if too_deep := _too_deep(context, measures, depth, (child, repr(parent)), request.within):
        yield too_deep
        return
    gap = measures[GapRequest(request.child, request.parent, frame)]
    if gap.distance > request.within:
        sentence = f"{child!r} is {_mm(gap.distance)} away from {parent!r}."
        fix = (
            f"{describe_move(child, gap_vector(gap))}, so that its face lies against {parent!r}."
            if is_near(context, request.child, gap.distance)
            else None
        )
        yield Violation(sentence, gap.distance, request.within, "m", gap.here, fix)
        return
    flush = measures[request]
    if flush.angle is None or flush.stands_out is None:
        yield Violation(f"{child!r} touches {parent!r}, but not with a face of its side.", at=gap.here)
        return
    if flush.angle > tolerances.flush_angle:
        yield Violation(
            f"the face of {child!r} that touches {parent!r} is {flush.angle:.1f}° from parallel to it.",
            flush.angle,
            tolerances.flush_angle,
            "°",
            flush.at,
        )
    elif flush.stands_out > tolerances.flush_overhang:
        yield Violation(
            f"the face of {child!r} extends {_mm(flush.stands_out)} beyond the face of {parent!r} that it touches.",
            flush.stands_out,
            tolerances.flush_overhang,
            "m",
            flush.at,
        )


R5 = relation_rule(
    "R5",
    "supported by",
    "SupportedBy(child, parents): the child's underside is at most ε above its parents (together), or as deep in them; "
    "the faces are opposed there; its centre of mass is over the hull of these contacts. A child that is also fastened "
    "or contained need not be balanced; one that also leans is balanced by both.",
    "An object that floats, stands on an edge or overhangs looks pasted in, and falls as soon as it is simulated.",
    "Lower or raise it until its underside meets its parents.",
    SupportedBy,
    requests=_support_requests,
    violations=_not_resting,
    tolerances=(*CONTACT, "opposed", "balance_share"),
)
R6 = relation_rule(
    "R6",
    "stable against",
    "StableAgainst(child, parent): a face of the child is at most ε from a face of the parent (or as deep in it), "
    "parallel to it, and does not extend beyond it.",
    "A picture that hangs in front of its wall, or a shelf that sticks out beyond it, is not held by it.",
    "Move the child until its face lies against the parent's; turn it parallel to it.",
    StableAgainst,
    requests=_flush_requests,
    violations=_not_leaning,
    tolerances=(*CONTACT, "flush_angle", "flush_overhang"),
)
RULES = (R5, R6)
