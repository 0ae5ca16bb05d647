"""What the relations say together: who holds whom, and where they contradict each other."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from agents.plan.faults import Fault
from agents.plan.part import owner_of
from agents.plan.relations import (
    Aperture,
    Direction,
    Distributed,
    EmbeddedIn,
    FixedAttachment,
    Inside,
    OnTopOf,
    Relation,
    StableAgainst,
    SupportedBy,
    SymmetricAbout,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

# What cannot hold of (a, b) and (b, a) at once, and what of one pair with another.
_OPPOSITE = {
    "LeftOf": "RightOf",
    "RightOf": "LeftOf",
    "InFrontOf": "Behind",
    "Behind": "InFrontOf",
    "Above": "Below",
    "Below": "Above",
}
_PAIRED = ("child", "parent", "part", "host", "filler", "content", "container", "a", "b")


def fields_of(relation: Relation) -> Iterator[tuple[str, str]]:
    """(field, node) for every object that a relation names: ``parents[1]``, ``child``."""
    if isinstance(relation, SupportedBy):
        yield "child", relation.child
        yield from ((f"parents[{place}]", node) for place, node in enumerate(relation.parents))
    elif isinstance(relation, (Distributed, SymmetricAbout)):
        yield from ((f"members[{place}]", node) for place, node in enumerate(relation.members))
        if isinstance(relation, Distributed) and isinstance(relation.about, str):
            yield "about", relation.about
    else:
        for field in _PAIRED:
            node = getattr(relation, field, None)
            if isinstance(node, str):
                yield field, node


def held_by(relation: Relation) -> Iterator[tuple[str, str]]:
    """(what is held, what holds it) for relations that keep something from falling."""
    match relation:
        case SupportedBy(child=child, parents=parents):
            yield from ((child, parent) for parent in parents)
        case StableAgainst(child=child, parent=parent):
            yield child, parent
        case FixedAttachment(part=part, host=host) | EmbeddedIn(part=part, host=host):
            yield part, host
        case Aperture(filler=filler, host=host):
            yield filler, host
        case Inside(content=content, container=container):
            yield content, container
        case OnTopOf(a=a, b=b):
            yield a, b
        case _:
            return


def faults_of(relations: Sequence[Relation]) -> Iterator[Fault]:
    """Relations that contradict themselves or each other."""
    yield from _with_itself(relations)
    yield from _told_twice(relations)
    yield from _circles(relations)
    yield from _directions(relations)


def _with_itself(relations: Sequence[Relation]) -> Iterator[Fault]:
    for place, relation in enumerate(relations):
        nodes = [node for _, node in fields_of(relation)]
        for node in dict.fromkeys(nodes):
            if nodes.count(node) > 1:
                yield Fault(f"relations[{place}]", f"{relation.kind} joins {node!r} with itself.")


def _told_twice(relations: Sequence[Relation]) -> Iterator[Fault]:
    seen: dict[str, int] = {}
    for place, relation in enumerate(relations):
        text = relation.model_dump_json()
        if text in seen:
            yield Fault(f"relations[{place}]", f"{relation.kind} says the same as relations[{seen[text]}].")
        seen.setdefault(text, place)


def _circles(relations: Sequence[Relation]) -> Iterator[Fault]:
    """A on B and B on A, or the same over several: nothing can hold itself."""
    held: dict[str, set[str]] = defaultdict(set)
    for place, relation in enumerate(relations):
        if not isinstance(relation, (SupportedBy, OnTopOf, Inside)):
            continue
        for child, bearer in held_by(relation):
            chain = _way(held, owner_of(bearer), owner_of(child))
            if owner_of(child) != owner_of(bearer) and chain:
                words = " on ".join(repr(name) for name in (owner_of(child), *chain))
                yield Fault(f"relations[{place}]", f"{relation.kind} closes a circle: {words}.")
            held[owner_of(child)].add(owner_of(bearer))


def _way(held: dict[str, set[str]], start: str, goal: str) -> list[str]:
    """The objects from ``start`` down to ``goal``; [] if there is no way."""
    waiting, seen = [[start]], {start}
    while waiting:
        path = waiting.pop()
        if path[-1] == goal:
            return path
        for below in sorted(held.get(path[-1], ())):
            if below not in seen:
                seen.add(below)
                waiting.append([*path, below])
    return []


def _directions(relations: Sequence[Relation]) -> Iterator[Fault]:
    said: dict[tuple[str, str, str, str], int] = {}
    for place, relation in enumerate(relations):
        if not isinstance(relation, Direction):
            continue
        opposite = _OPPOSITE[relation.kind]
        for key in (
            (relation.kind, relation.b, relation.a, relation.frame),
            (opposite, relation.a, relation.b, relation.frame),
        ):
            if key in said:
                yield Fault(
                    f"relations[{place}]",
                    f"{relation.a!r} cannot be {relation.kind} {relation.b!r}: relations[{said[key]}] says otherwise.",
                )
        said[relation.kind, relation.a, relation.b, relation.frame] = place
