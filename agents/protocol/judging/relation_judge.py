"""Judging one kind of relation of a plan: when it is looked at, and what is said where it does not hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar, cast

from agents.protocol.judging.sample_frames import moments
from agents.protocol.measures.measure import Unmeasured
from agents.protocol.rule import Idle

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from agents.plan.part import Part
    from agents.protocol.facts import Vector
    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures, Request
    from agents.protocol.rule import Rule, Subject

Kind = TypeVar("Kind", bound="Part")


@dataclass(frozen=True, slots=True)
class Miss:
    """One way in which a relation fails to hold: a sentence, what was measured, and what would do instead.

    ``objects`` are whom it is about, where that is not all whom the relation joins.
    """

    sentence: str
    measured: float | None = None
    tolerance: float | None = None
    unit: str = ""
    at: Vector | None = None
    fix: str | None = None
    objects: tuple[str, ...] = ()


def planned(
    subject: Subject, *kinds: type[Kind], only: Callable[[Kind], bool] | None = None
) -> Iterator[tuple[int, Kind]]:
    """(place in the plan, relation) of some kinds; of those only which ``only`` is true for."""
    for place, relation in enumerate(subject.planned.relations):
        if isinstance(relation, kinds):
            found = cast("Kind", relation)
            if only is None or only(found):
                yield place, found


def asked(
    subject: Subject,
    *kinds: type[Kind],
    ask: Callable[[Subject, Kind, int | None], Iterable[Request[Any]]],
    only: Callable[[Kind], bool] | None = None,
    what: str = "",
) -> Iterator[Request[Any]]:
    """What ``ask`` wants measured of every relation, at every moment at which it may hold.

    Raises Idle, naming ``what`` the plan does not have (else the kinds).
    """
    found = [relation for _, relation in planned(subject, *kinds, only=only)]
    if not found:
        raise Idle(f"the plan has no {what or ' or '.join(kind.__name__ for kind in kinds)}")
    for relation in found:
        if not _absent(subject, relation):
            for frame in moments(subject, *_nodes(relation)):
                yield from ask(subject, relation, frame)


def judged(
    rule: Rule,
    subject: Subject,
    measures: Measures,
    *kinds: type[Kind],
    misses: Callable[[Subject, Measures, Kind, int | None], Iterable[Miss]],
    only: Callable[[Kind], bool] | None = None,
) -> Iterator[Finding]:
    """Findings of relations that hold at none of their moments: of the one at which least is amiss.

    ``misses`` may raise Unmeasured.
    """
    for place, relation in planned(subject, *kinds, only=only):
        nodes = _nodes(relation)
        if absent := _absent(subject, relation):
            yield rule.undecided(nodes, f"there is nothing with a surface that is called {absent!r}")
            continue
        reason: Unmeasured | None = None
        found: list[tuple[int | None, list[Miss]]] = []
        for frame in moments(subject, *nodes):
            try:
                found.append((frame, list(misses(subject, measures, relation, frame))))
            except Unmeasured as told:
                reason = told
        if any(not amiss for _, amiss in found):
            continue
        if reason is not None:
            yield rule.undecided(nodes, reason)
            continue
        frame, amiss = min(found, key=lambda one: (len(one[1]), sum(map(_excess, one[1]))))
        for miss in amiss:
            yield rule.finding(
                miss.objects or nodes,
                f"relations[{place}]: {miss.sentence}",
                fix=miss.fix or rule.fix,
                frame=frame,
                measured=miss.measured,
                tolerance=miss.tolerance,
                unit=miss.unit,
                at=miss.at,
            )


def _excess(miss: Miss) -> float:
    return abs((miss.measured or 0.0) - (miss.tolerance or 0.0))


def surfaces(subject: Subject, *nodes: str, but: tuple[str, ...] = ()) -> tuple[str, ...]:
    """The surfaces of some nodes, without those of another one that is a part of them."""
    names = dict.fromkeys(name for node in nodes for name in subject.structure.find(node))
    return tuple(name for name in names if name not in but)


def smallest(subject: Subject, *groups: tuple[str, ...]) -> float:
    """The smallest dimension of any of some objects, in metres; 0 where none has one."""
    objects = subject.structure.objects
    sizes = [
        size for group in groups for name in group for size in objects[name].dimensions or () if size > 0
    ]
    return min(sizes, default=0.0)


def _nodes(relation: object) -> tuple[str, ...]:
    return cast("tuple[str, ...]", cast("Any", relation).nodes)


def _absent(subject: Subject, relation: object) -> str | None:
    """The first node that stands for nothing, or for nothing but a part of the node before it."""
    first, *rest = _nodes(relation)
    own = subject.structure.find(first)
    if not own:
        return first
    return next((node for node in rest if not surfaces(subject, node, but=own)), None)
