"""The plan's objects and relations as tables, those that are alike in one row."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.plan.relations import Distributed, SymmetricAbout
from agents.protocol.report.text_format import fold_names
from agents.views.formatting import swatch
from agents.views.report.links import category_of, describe_terms

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.relations import Relation
    from agents.plan.scene import PlannedObject, ScenePlan

_NAMED = 6
_FEWEST_ALIKE = 3


@dataclass(frozen=True, slots=True)
class ObjectRow:
    """Objects that differ in place only. Lengths in metres; ``swatch`` is a CSS colour."""

    name: str
    role: str
    dimensions: str
    systems: str
    material: str
    surface: str
    swatch: str
    description: str


@dataclass(frozen=True, slots=True)
class RelationRow:
    """Relations that say the same of different objects."""

    kind: str
    category: str
    subject: str
    others: str
    terms: str
    count: int


def objects_of(plan: ScenePlan) -> list[ObjectRow]:
    """All objects, in the plan's order."""
    alike: dict[object, list[PlannedObject]] = {}
    for one in plan.objects:
        key = (one.role, one.dimensions, one.systems, one.material, one.description)
        alike.setdefault(key, []).append(one)
    return [_object_row(members) for members in alike.values()]


def _object_row(members: Sequence[PlannedObject]) -> ObjectRow:
    one = members[0]
    surface = []
    if one.material:
        surface = [f"roughness {one.material.roughness:g}"]
        surface += [f"metallic {one.material.metallic:g}"] * bool(one.material.metallic)
        surface += [f"transmission {one.material.transmission:g}"] * bool(one.material.transmission)
        surface += [one.material.texture] * bool(one.material.texture)
    return ObjectRow(
        name=fold_names((member.name for member in members), _NAMED),
        role=one.role,
        dimensions=" × ".join(f"{size:g}" for size in one.dimensions),
        systems=", ".join(one.systems),
        material=one.material.name if one.material else "",
        surface=", ".join(surface),
        swatch=swatch(one.material.base_color) if one.material else "",
        description=one.description,
    )


def relations_of(plan: ScenePlan) -> list[RelationRow]:
    """All relations; those fold that relate many to the same, or else those of one kind."""
    shared = Counter((one.kind, _ends(one)[1]) for one in plan.relations)
    alike: dict[tuple[str, str, tuple[str, ...]], list[Relation]] = {}
    for one in plan.relations:
        others = _ends(one)[1]
        is_shared = shared[one.kind, others] >= _FEWEST_ALIKE
        alike.setdefault((one.kind, describe_terms(one), others if is_shared else ()), []).append(one)
    return [
        RelationRow(
            kind=kind,
            category=category_of(members[0]),
            subject=fold_names((node for one in members for node in _ends(one)[0]), _NAMED),
            others=fold_names((node for one in members for node in _ends(one)[1]), _NAMED),
            terms=terms,
            count=len(members),
        )
        for (kind, terms, _), members in alike.items()
    ]


def _ends(relation: Relation) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What a relation is about, and what it relates that to."""
    members = len(relation.members) if isinstance(relation, (Distributed, SymmetricAbout)) else 1
    return relation.nodes[:members], relation.nodes[members:]
