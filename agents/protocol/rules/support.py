"""R5 and R6: what rests on something, and what leans on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.plan.relations import Aperture, EmbeddedIn, FixedAttachment, Inside, StableAgainst, SupportedBy
from agents.protocol.judging.balance import balance
from agents.protocol.judging.contact_pairs import smallest_diagonal
from agents.protocol.judging.move_advice import across, told_move
from agents.protocol.judging.relation_judge import Miss, asked, judged, planned, smallest, surfaces
from agents.protocol.measures.contact import Depth, Flush, Support
from agents.protocol.measures.measure import Gap, Measures, Request
from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from agents.protocol.facts import Vector
    from agents.protocol.findings import Finding

_ON_A_LINE = 1e-4  # metres that a centre of mass may be beside a line or point that bears it
_LINE = 1e-8  # m² of a hull that is no more than that


def _epsilon(subject: Subject, ours: tuple[str, ...], theirs: tuple[str, ...]) -> float:
    return subject.tolerances.contact_gap(smallest_diagonal(subject, ours, theirs))


def _sunk(
    subject: Subject, measures: Measures, request: Depth, names: tuple[str, str], epsilon: float
) -> Miss | None:
    """A child that is deeper in what holds it than it may be above it."""
    found = measures[request]
    most = max(epsilon, subject.tolerances.noise(smallest(subject, request.a, request.b)))
    if found.depth <= most:
        return None
    sentence = f"{names[0]!r} is {_mm(found.depth)} deep in {names[1]}."
    fix = f"Move {names[0]!r} out by {_mm(found.depth)}, so that the surfaces meet."
    return Miss(sentence, found.depth, most, "m", found.at, fix)


def _mm(length: float) -> str:
    return f"{length * 1000:.1f} mm"


# R5: resting on


def _supports(subject: Subject, child: str) -> Iterator[SupportedBy]:
    """All that the plan says about what bears a child: each may give a part of it."""
    yield from (one for _, one in planned(subject, SupportedBy) if one.child == child)


def _leans(subject: Subject, child: str) -> Iterator[StableAgainst]:
    yield from (one for _, one in planned(subject, StableAgainst) if one.child == child)


def _is_held(subject: Subject, child: str, *kinds: type[Any]) -> bool:
    """Whether something keeps a child from tipping: it is fastened, fitted into something, or in a container."""
    return any(relation.nodes[0] == child for _, relation in planned(subject, *kinds))


def _support(subject: Subject, relation: SupportedBy, frame: int | None) -> Support:
    child = surfaces(subject, relation.child)
    parents = surfaces(subject, *relation.parents, but=child)
    # What leans stands on an edge: its underside is not turned to what bears it.
    free = not any(_leans(subject, relation.child))
    opposed = subject.tolerances.opposed if free else 0.0
    return Support(child, parents, _epsilon(subject, child, parents), opposed, frame)


def _ask_rests(subject: Subject, relation: SupportedBy, frame: int | None) -> Iterator[Request[Any]]:
    found = _support(subject, relation, frame)
    yield found
    yield Depth(found.child, found.parents, frame)
    yield from (_flush(subject, one, frame) for one in _leans(subject, relation.child))


def _ask_support(subject: Subject) -> Iterator[Request[Any]]:
    yield from asked(subject, SupportedBy, ask=_ask_rests)


def _rests(subject: Subject, measures: Measures, relation: SupportedBy, frame: int | None) -> Iterator[Miss]:
    request = _support(subject, relation, frame)
    child, parents = relation.child, " and ".join(map(repr, relation.parents))
    if not _is_held(subject, child, EmbeddedIn):
        depth = Depth(request.child, request.parents, frame)
        if sunk := _sunk(subject, measures, depth, (child, parents), request.within):
            yield sunk
            return
    found = measures[request]
    if found.opposed is None:
        yield _floats(child, parents, found.clearance, found.at, request.within)
        return
    if _is_held(subject, child, FixedAttachment, Aperture, EmbeddedIn, Inside):
        return
    if found.opposed > request.opposed:
        turn = math.degrees(math.acos(max(-1.0, min(1.0, -found.opposed))))
        yield Miss(
            f"{child!r} touches {parents} with a face that is turned {turn:.1f}° against it: it stands on an edge.",
            found.opposed,
            request.opposed,
            "",
            found.at,
            "Turn it until its underside lies on what bears it.",
        )
        return
    yield from _tips(subject, measures, relation, frame)


def _floats(child: str, parents: str, clearance: float | None, at: Vector | None, most: float) -> Miss:
    if clearance is None:
        return Miss(f"{child!r} has nothing of {parents} below it.", None, most, "m", at)
    if clearance > most:
        sentence = f"{child!r} floats {_mm(clearance)} above {parents}."
        return Miss(sentence, clearance, most, "m", at, f"Move {child!r} {_mm(clearance)} down (−Z).")
    return Miss(f"{child!r} touches {parents}, but nothing of it lies on top.", None, most, "m", at)


def _tips(subject: Subject, measures: Measures, relation: SupportedBy, frame: int | None) -> Iterator[Miss]:
    bearing = [
        place
        for one in _supports(subject, relation.child)
        if surfaces(subject, *one.parents, but=surfaces(subject, one.child))
        for place in measures[_support(subject, one, frame)].bearing
    ]
    for lean in _leans(subject, relation.child):
        bearing += measures[_flush(subject, lean, frame)].touching
    centre = measures[_support(subject, relation, frame)].centre
    margin, area = balance(bearing, centre)
    inset = subject.tolerances.balance_share * math.sqrt(area) if area > _LINE else -_ON_A_LINE
    if margin >= inset:
        return
    where = f"{_mm(-margin)} outside" if margin < 0 else f"only {_mm(margin)} inside"
    yield Miss(
        f"the centre of mass of {relation.child!r} is {where} of what bears it: it tips over.",
        margin,
        inset,
        "m",
        centre,
        "Move it over what bears it, widen its base, or turn it upright.",
    )


def _judge_support(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R5, subject, measures, SupportedBy, misses=_rests)


# R6: leaning on


def _flush(subject: Subject, relation: StableAgainst, frame: int | None) -> Flush:
    child = surfaces(subject, relation.child)
    parent = surfaces(subject, relation.parent, but=child)
    # A cupboard that stands on a room's floor and at its wall is to be looked at where it is at the wall.
    sideways = any(relation.parent in one.parents for one in _supports(subject, relation.child))
    return Flush(child, parent, _epsilon(subject, child, parent), sideways, frame)


def _ask_flush(subject: Subject, relation: StableAgainst, frame: int | None) -> Iterator[Request[Any]]:
    found = _flush(subject, relation, frame)
    yield found
    yield Gap(found.child, found.parent, frame)
    yield Depth(found.child, found.parent, frame)


def _ask_leaning(subject: Subject) -> Iterator[Request[Any]]:
    yield from asked(subject, StableAgainst, ask=_ask_flush)


def _leaning(
    subject: Subject, measures: Measures, relation: StableAgainst, frame: int | None
) -> Iterator[Miss]:
    request, tolerances = _flush(subject, relation, frame), subject.tolerances
    child, parent = relation.child, relation.parent
    depth = Depth(request.child, request.parent, frame)
    if sunk := _sunk(subject, measures, depth, (child, repr(parent)), request.within):
        yield sunk
        return
    gap = measures[Gap(request.child, request.parent, frame)]
    if gap.distance > request.within:
        sentence = f"{child!r} is {_mm(gap.distance)} away from {parent!r}."
        fix = f"{told_move(child, across(gap))}, so that its face lies at {parent!r}."
        yield Miss(sentence, gap.distance, request.within, "m", gap.here, fix)
        return
    found = measures[request]
    if found.angle is None or found.stands_out is None:
        yield Miss(f"{child!r} touches {parent!r}, but not with a face of its side.", at=gap.here)
        return
    if found.angle > tolerances.flush_angle:
        yield Miss(
            f"the face of {child!r} that touches {parent!r} is turned {found.angle:.1f}° against it.",
            found.angle,
            tolerances.flush_angle,
            "°",
            found.at,
        )
    elif found.stands_out > tolerances.flush_overhang:
        yield Miss(
            f"the face of {child!r} reaches {_mm(found.stands_out)} beyond the face of {parent!r} that it is at.",
            found.stands_out,
            tolerances.flush_overhang,
            "m",
            found.at,
        )


def _judge_leaning(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R6, subject, measures, StableAgainst, misses=_leaning)


R5 = Rule(
    "R5",
    "supported by",
    "hard",
    "SupportedBy(child, parents): the child's underside is at most ε above its parents (together), or as deep in them; "
    "the faces are turned to each other there; its centre of mass is over the hull of these contacts. What is also "
    "fastened or contained need not balance; what also leans balances on both.",
    "What floats, stands on an edge or hangs over falls as soon as it is simulated, and looks pasted in before.",
    "Lower or raise it until its underside meets what bears it.",
    _judge_support,
    _ask_support,
    needs_plan=True,
    tolerances=("contact", "contact_share", "contact_most", "opposed", "balance_share"),
)
R6 = Rule(
    "R6",
    "stable against",
    "hard",
    "StableAgainst(child, parent): a face of the child is at most ε from one of the parent (or as deep in it), "
    "parallel to it, and does not reach beyond it.",
    "A picture that hangs before its wall, or a shelf that stands out over its end, is not held by it.",
    "Move the child until its face lies at the parent's; turn it parallel to it.",
    _judge_leaning,
    _ask_leaning,
    needs_plan=True,
    tolerances=("contact", "contact_share", "contact_most", "flush_angle", "flush_overhang"),
)
RULES = (R5, R6)
