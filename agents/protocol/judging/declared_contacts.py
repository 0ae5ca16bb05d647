"""The contacts that tags and the plan declare."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.plan.graph import held_by
from agents.plan.relations import CONTACTS, EmbeddedIn, Inside

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.relations import RelationPart
    from agents.protocol.rule import RuleContext


@dataclass(frozen=True, slots=True)
class DeclaredContact:
    """A declaration that ``a`` touches ``b``. ``by`` names its source: a tag of an object, or a ``relation``."""

    a: str
    b: str
    by: str
    relation: RelationPart | None = None


def declared_contacts(context: RuleContext) -> Iterator[DeclaredContact]:
    """All declared contacts, each pair once, with the names that the declarations use."""
    seen: set[frozenset[str]] = set()
    for contact in declarations(context):
        pair = frozenset((contact.a, contact.b))
        if pair not in seen:
            seen.add(pair)
            yield contact


def declarations(context: RuleContext) -> Iterator[DeclaredContact]:
    """All declared contacts; a pair twice where both declare it."""
    yield from _of_tags(context)
    yield from _of_plan(context)


def _of_tags(context: RuleContext) -> Iterator[DeclaredContact]:
    for item in context.facts.objects:
        for other in item.contact_with:
            yield DeclaredContact(item.name, other, f"contact_with of {item.name!r}")


def _of_plan(context: RuleContext) -> Iterator[DeclaredContact]:
    for place, relation in enumerate(context.plan.relations if context.plan else ()):
        if isinstance(relation, CONTACTS):
            for child, parent in held_by(relation):
                yield DeclaredContact(child, parent, f"relations[{place}] ({relation.kind})", relation)


def allowed_crossings(context: RuleContext) -> set[frozenset[str]]:
    """Pairs of meshes that may cross, since they are declared to touch or to be in each other."""
    structure = context.structure
    nodes = [(contact.a, contact.b) for contact in declared_contacts(context)]
    for relation in context.plan.relations if context.plan else ():
        if isinstance(relation, (EmbeddedIn, Inside)):
            nodes += held_by(relation)
    return {
        frozenset((mesh, other))
        for a, b in nodes
        for mesh in structure.surfaces_of(a)
        for other in structure.surfaces_of(b)
        if other != mesh
    }
