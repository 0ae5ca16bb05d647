"""R18: what is to travel with something keeps its place in it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.plan.part import owner_of
from agents.plan.relations import CoMoves
from agents.protocol.judging.contact_pairs import diagonal_around
from agents.protocol.judging.phases import RESTING, body_of
from agents.protocol.judging.relation_judge import planned
from agents.protocol.measures.measure import Measures, Unmeasured
from agents.protocol.measures.motion import Together
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding


def _relations(subject: Subject) -> list[tuple[int, CoMoves]]:
    found = list(planned(subject, CoMoves))
    if not found:
        raise Idle("the plan has no CoMoves")
    return found


def _spans(subject: Subject, relation: CoMoves) -> list[tuple[int, int]]:
    """When the two move: in the phases of what carries; without any, in those of what is carried; or all the time."""
    for node in (relation.b, relation.a):
        found = [
            (phase.start, phase.end)
            for phase in subject.planned.motion.phases
            if phase.actor == owner_of(node) and phase.kind not in RESTING and phase.end > phase.start
        ]
        if found:
            return found
    return [(subject.facts.frame_start, subject.facts.frame_end)]


def _asked(subject: Subject, relation: CoMoves) -> list[Together]:
    """Raises Unmeasured where there is nothing of one of the two."""
    b = body_of(subject, relation.b)
    a = tuple(name for name in body_of(subject, relation.a) if name not in b)
    if "/" in relation.a and owner_of(relation.a) == relation.b:
        # A part against the rest of its own object.
        a = body_of(subject, relation.a)
        b = tuple(name for name in b if name not in a)
    for node, names in ((relation.a, a), (relation.b, b)):
        if not names:
            raise Unmeasured(f"there is nothing called {node!r}")
    return [Together(a, b, start, end) for start, end in _spans(subject, relation)]


def _requests(subject: Subject) -> Iterator[Together]:
    for _, relation in _relations(subject):
        try:
            yield from _asked(subject, relation)
        except Unmeasured:
            continue  # told when it is judged


def _judge(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for place, relation in _relations(subject):
        try:
            for request in _asked(subject, relation):
                yield from _parted(subject, measures, (place, relation), request)
        except Unmeasured as reason:
            yield R18.undecided(relation.nodes, reason)


def _parted(
    subject: Subject, measures: Measures, named: tuple[int, CoMoves], request: Together
) -> Iterator[Finding]:
    place, relation = named
    tolerances, found = subject.tolerances, measures[request]
    begin = f"relations[{place}]: from frame {request.start} on {relation.a!r}"
    most = max(tolerances.comove, tolerances.comove_share * diagonal_around(subject, request.a))
    if found.shift > most:
        yield R18.finding(
            relation.nodes,
            f"{begin} shifts by {found.shift:.3f} m against {relation.b!r}.",
            frame=found.shift_frame,
            measured=found.shift,
            tolerance=most,
            unit="m",
            at=found.at,
        )
    if found.turn is not None and (turn := math.degrees(found.turn)) > tolerances.comove_turn:
        yield R18.finding(
            relation.nodes,
            f"{begin} turns by {turn:.1f}° against {relation.b!r}.",
            frame=found.turn_frame,
            measured=turn,
            tolerance=tolerances.comove_turn,
            unit="°",
        )


R18 = Rule(
    "R18",
    "moving together",
    "hard",
    "CoMoves(a, b): a keeps its place and rotation in b while b moves.",
    "A rider who slides out of the saddle, or a lamp that stays behind its car, breaks the scene at once.",
    "Parent the one to the other, or give it a Child Of or Copy Transforms constraint, without keyframes of its own.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=("comove", "comove_share", "comove_turn"),
)
RULES = (R18,)
