"""R1: the scene has all planned objects, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rule import Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import ObjectFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures


def _judge(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure, plan = context.structure, context.planned
    for planned in plan.objects:
        name = planned.name
        if planned.role == "force":
            continue  # a solver's partner, not geometry: R15 looks for it
        obj = structure.by_name.get(name)
        if obj is None:
            yield R1.finding(
                (name,),
                f"The planned object {name!r} is missing: no L3 collection has that name.",
                measured=0.0,
            )
        elif not any(mesh.rendered and _is_visible(mesh) for mesh in obj.meshes):
            hidden = any(_is_visible(mesh) for mesh in obj.meshes)
            reason = "all its meshes are hidden from renders" if hidden else "it has no mesh with a surface"
            yield R1.finding((name,), f"{name!r} does not show in renders: {reason}.", measured=0.0)
    names = {planned.name for planned in plan.objects}
    for obj in structure.logical_objects:
        if obj.name not in names:
            yield R1.finding((obj.name,), f"{obj.name!r} is an object of the scene, but not of the plan.")


def _is_visible(mesh: ObjectFacts) -> bool:
    """Whether a render can show something of it, at least at some frame."""
    return mesh.surface or mesh.type in {"CURVES", "POINTCLOUD", "VOLUME"} or mesh.is_fluid_domain


R1 = Rule(
    "R1",
    "inventory",
    "hard",
    "Each planned object is exactly one L3 with a mesh that renders; every L3 is planned.",
    "A missing object is not seen, and an unplanned one confuses every later check.",
    "Make what is missing under its planned name, show what is hidden, remove or rename what is not planned.",
    _judge,
    needs_plan=True,
)
RULES = (R1,)
