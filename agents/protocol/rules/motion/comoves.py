"""R18: an object that moves with another keeps its place relative to it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.plan.part import owner_of
from agents.plan.relations import CoMoves
from agents.protocol.judging.measured_motion import followed_names
from agents.protocol.judging.phases import RESTING
from agents.protocol.judging.planned_relations import relations_of
from agents.protocol.judging.sizes import diagonal_around
from agents.protocol.measures.motion import RelativeMotionRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding


def _relations(context: RuleContext) -> list[tuple[int, CoMoves]]:
    relations = list(relations_of(context, CoMoves))
    if not relations:
        raise NotApplicable("the plan has no CoMoves")
    return relations


def _spans(context: RuleContext, relation: CoMoves) -> list[tuple[int, int]]:
    """When the two move: in the phases of ``b``; without any, in those of ``a``; without these, all the time."""
    for node in (relation.b, relation.a):
        spans = [
            (phase.start, phase.end)
            for phase in context.planned.motion.phases
            if phase.actor == owner_of(node) and phase.kind not in RESTING and phase.end > phase.start
        ]
        if spans:
            return spans
    return [(context.facts.frame_start, context.facts.frame_end)]


def _motion_requests(context: RuleContext, relation: CoMoves) -> list[RelativeMotionRequest]:
    """Raises Unmeasured if one of the two is missing."""
    b = followed_names(context, relation.b)
    a = tuple(name for name in followed_names(context, relation.a) if name not in b)
    if "/" in relation.a and owner_of(relation.a) == relation.b:
        # A part against the rest of its own object.
        a = followed_names(context, relation.a)
        b = tuple(name for name in b if name not in a)
    for node, names in ((relation.a, a), (relation.b, b)):
        if not names:
            raise Unmeasured(f"no object is named {node!r}")
    return [RelativeMotionRequest(a, b, start, end) for start, end in _spans(context, relation)]


def _requests(context: RuleContext) -> Iterator[RelativeMotionRequest]:
    for _, relation in _relations(context):
        try:
            yield from _motion_requests(context, relation)
        except Unmeasured:
            continue  # reported when it is judged


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for place, relation in _relations(context):
        try:
            for request in _motion_requests(context, relation):
                yield from _parted(context, measures, (place, relation), request)
        except Unmeasured as reason:
            yield R18.undecided(relation.nodes, reason)


def _parted(
    context: RuleContext, measures: Measures, indexed: tuple[int, CoMoves], request: RelativeMotionRequest
) -> Iterator[Finding]:
    place, relation = indexed
    tolerances, motion = context.tolerances, measures[request]
    label = f"relations[{place}]: from frame {request.start} on, {relation.a!r}"
    most = max(tolerances.comove, tolerances.comove_share * diagonal_around(context, request.a))
    if motion.shift > most:
        yield R18.finding(
            relation.nodes,
            f"{label} shifts by {motion.shift:.3f} m relative to {relation.b!r}.",
            frame=motion.shift_frame,
            measured=motion.shift,
            tolerance=most,
            unit="m",
            at=motion.at,
        )
    if motion.turn is not None and (turn := math.degrees(motion.turn)) > tolerances.comove_turn:
        yield R18.finding(
            relation.nodes,
            f"{label} turns by {turn:.1f}° relative to {relation.b!r}.",
            frame=motion.turn_frame,
            measured=turn,
            tolerance=tolerances.comove_turn,
            unit="°",
        )


R18 = Rule(
    "R18",
    "moving together",
    "hard",
    "CoMoves(a, b): a keeps its place and rotation relative to b while b moves.",
    "A rider who slides out of the saddle, or a lamp that stays behind its car, breaks the scene at once.",
    "Parent one to the other, or give it a Child Of or Copy Transforms constraint, without keyframes of its own.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=("comove", "comove_share", "comove_turn"),
)
RULES = (R18,)
