"""What the relations of a plan say together: who holds whom, and where they contradict each other."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from agents.plan.faults import Fault
from agents.plan.part import owner_of
from agents.plan.relations import CONTACTS, Direction, Inside, OnTopOf, Relation, SupportedBy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

_OPPOSITE = {
    "LeftOf": "RightOf",
    "RightOf": "LeftOf",
    "InFrontOf": "Behind",
    "Behind": "InFrontOf",
    "Above": "Below",
    "Below": "Above",
}
_FIRST_AND_LAST = {"start_or_end", "end"}  # of two relations, when they must hold: each has a time of its own


def reachable(starts: Iterable[str], links: Callable[[str], Iterable[str]]) -> dict[str, None]:
    """The names that ``links`` leads to from ``starts``, over any number of steps; the starts come first."""
    names = dict.fromkeys(starts)
    queue = list(names)
    for name in queue:
        new = [other for other in dict.fromkeys(links(name)) if other not in names]
        names.update(dict.fromkeys(new))
        queue += new
    return names


def held_by(relation: Relation) -> Iterator[tuple[str, str]]:
    """(what is held, what holds it) for relations that keep something from falling."""
    if isinstance(relation, (*CONTACTS, Inside, OnTopOf)):
        held, *holders = relation.nodes
        yield from ((held, holder) for holder in holders)


def relation_faults(relations: Sequence[Relation]) -> Iterator[Fault]:
    """Relations that contradict themselves or each other."""
    yield from _self_relations(relations)
    yield from _duplicates(relations)
    yield from _cycles(relations)
    yield from _opposed_directions(relations)


def _self_relations(relations: Sequence[Relation]) -> Iterator[Fault]:
    for place, relation in enumerate(relations):
        for node, times in Counter(relation.nodes).items():
            if times > 1:
                yield Fault(
                    f"relations[{place}]", f"{relation.kind} names {node!r} twice; name each object once."
                )


def _duplicates(relations: Sequence[Relation]) -> Iterator[Fault]:
    seen: dict[str, int] = {}
    for place, relation in enumerate(relations):
        text = relation.model_dump_json()
        if text in seen:
            yield Fault(
                f"relations[{place}]",
                f"{relation.kind} repeats relations[{seen[text]}]; remove one of the two.",
            )
        seen.setdefault(text, place)


def _cycles(relations: Sequence[Relation]) -> Iterator[Fault]:
    """A on B and B on A, directly or through others: nothing can hold itself."""
    held: dict[str, set[str]] = defaultdict(set)
    tower = _Tower()
    for place, relation in enumerate(relations):
        if not isinstance(relation, (SupportedBy, OnTopOf, Inside)):
            continue
        for held_node, holder_node in held_by(relation):
            child, parent = owner_of(held_node), owner_of(holder_node)
            if child != parent and tower.has(parent, child):
                words = " on ".join(repr(name) for name in (child, *_path(held, parent, child)))
                yield Fault(f"relations[{place}]", f"{relation.kind} closes a cycle: {words}.")
            held[child].add(parent)
            tower.add(child, parent)


class _Tower:
    """Which objects are below which, over any number of steps, without a walk down the tower for each relation."""

    def __init__(self) -> None:
        self._below: defaultdict[str, set[str]] = defaultdict(set)
        self._above: defaultdict[str, set[str]] = defaultdict(set)

    def has(self, upper: str, lower: str) -> bool:
        """Whether ``lower`` is below ``upper``."""
        return lower in self._below[upper]

    def add(self, upper: str, lower: str) -> None:
        """``upper`` stands on ``lower``: all that is above the one is above all that is below the other."""
        if self.has(upper, lower):
            return
        uppers, lowers = {upper, *self._above[upper]}, {lower, *self._below[lower]}
        for name in uppers:
            self._below[name] |= lowers
        for name in lowers:
            self._above[name] |= uppers


def _path(held: dict[str, set[str]], start: str, goal: str) -> list[str]:
    """The objects from ``start`` down to ``goal``, which is below it."""
    stack, above = [start], {start: ""}
    while stack[-1] != goal:
        name = stack.pop()
        for below in sorted(held.get(name, ())):
            if below not in above:
                above[below] = name
                stack.append(below)
    path = [goal]
    while path[-1] != start:
        path.append(above[path[-1]])
    return path[::-1]


def _opposed_directions(relations: Sequence[Relation]) -> Iterator[Fault]:
    """Left of and right of at one time; what is left of something at first may be right of it at the end."""
    stated: dict[tuple[str, str, str, str], list[int]] = defaultdict(list)
    for place, relation in enumerate(relations):
        if not isinstance(relation, Direction):
            continue
        opposite = _OPPOSITE[relation.kind]
        for key in (
            (relation.kind, relation.b, relation.a, relation.frame),
            (opposite, relation.a, relation.b, relation.frame),
        ):
            for other in stated[key]:
                if {relation.when, relations[other].when} != _FIRST_AND_LAST:
                    words = f"{relation.a!r} cannot be {relation.kind} {relation.b!r}"
                    yield Fault(f"relations[{place}]", f"{words}: relations[{other}] contradicts it.")
        stated[relation.kind, relation.a, relation.b, relation.frame].append(place)
