"""Which pairs of surfaces are said to touch, by tags and by the plan, and how far apart or deep they may be."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING

from agents.plan.graph import held_by
from agents.plan.relations import CONTACTS, EmbeddedIn, Inside
from agents.protocol.facts import Box

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.rule import Subject


@dataclass(frozen=True, slots=True)
class Contact:
    """Somebody says that ``a`` touches ``b``. ``by`` tells who: a tag on an object, or a relation of the plan."""

    a: str
    b: str
    by: str


def declared(subject: Subject) -> Iterator[Contact]:
    """Every declared contact, each pair once; names as they were given."""
    seen: set[frozenset[str]] = set()
    for contact in (*_tagged(subject), *_planned(subject)):
        pair = frozenset((contact.a, contact.b))
        if pair not in seen:
            seen.add(pair)
            yield contact


def _tagged(subject: Subject) -> Iterator[Contact]:
    for one in subject.facts.objects:
        for other in one.contact_with:
            yield Contact(one.name, other, f"contact_with of {one.name!r}")


def _planned(subject: Subject) -> Iterator[Contact]:
    if subject.plan is None:
        return
    for place, relation in enumerate(subject.plan.relations):
        if isinstance(relation, CONTACTS):
            for child, bearer in held_by(relation):
                yield Contact(child, bearer, f"relations[{place}] ({relation.kind})")


def may_cross(subject: Subject) -> set[frozenset[str]]:
    """Pairs of meshes that are declared to touch or to be in each other: their penetration is no surprise."""
    structure = subject.structure
    pairs: set[frozenset[str]] = set()
    nodes = [(contact.a, contact.b) for contact in declared(subject)]
    if subject.plan is not None:
        nodes += [
            (inner, outer)
            for relation in subject.plan.relations
            if isinstance(relation, (EmbeddedIn, Inside))
            for inner, outer in held_by(relation)
        ]
    for a, b in nodes:
        for one in structure.find(a):
            pairs.update(frozenset((one, other)) for other in structure.find(b) if other != one)
    return pairs


def smallest_diagonal(subject: Subject, *groups: tuple[str, ...]) -> float:
    """Of the boxes around each mesh of some groups, the smallest one's diagonal; 0 where there is none.

    Each mesh counts by itself: a table's leg stands on the floor no less closely for the size of the table.
    """
    objects = subject.structure.objects
    boxes = (objects[name].box for names in groups for name in names)
    return min((box.diagonal for box in boxes if box is not None), default=0.0)


def diagonal_around(subject: Subject, names: tuple[str, ...]) -> float:
    """The diagonal of the box around all of some meshes; 0 where there is none."""
    objects = subject.structure.objects
    boxes = [box for name in names if (box := objects[name].box) is not None]
    return reduce(Box.joined, boxes).diagonal if boxes else 0.0
