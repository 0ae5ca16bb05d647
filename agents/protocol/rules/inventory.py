"""R1: what was planned is there, and nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import ObjectFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures


def _judge(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure, plan = subject.structure, subject.planned
    planned = {one.name for one in plan.objects}
    for one in plan.objects:
        if one.role == "force":
            field = structure.objects.get(one.name)
            if field is None or field.force_field is None:
                yield R1.finding(
                    (one.name,), f"The plan has a force field {one.name!r}; the scene has none of that name."
                )
            continue
        thing = structure.by_name.get(one.name)
        if thing is None:
            yield R1.finding(
                (one.name,), f"The plan has {one.name!r}, but no object (L3) is called so.", measured=0.0
            )
        elif not any(mesh.rendered and _is_seen(mesh) for mesh in thing.meshes):
            seen = any(_is_seen(mesh) for mesh in thing.meshes)
            what = "all its meshes are hidden from renders" if seen else "it has no mesh with a surface"
            yield R1.finding((one.name,), f"{one.name!r} is there, but {what}.", measured=0.0)
    for thing in structure.things:
        if thing.name not in planned:
            yield R1.finding((thing.name,), f"{thing.name!r} is an object of the scene, but not of the plan.")


def _is_seen(mesh: ObjectFacts) -> bool:
    """Whether there is something of it to be seen, at some frame at least."""
    return (
        mesh.surface
        or mesh.type in {"CURVES", "POINTCLOUD", "VOLUME"}
        or any(modifier.type == "FLUID_DOMAIN" for modifier in mesh.modifiers)
    )


R1 = Rule(
    "R1",
    "inventory",
    "hard",
    "Each planned object is exactly one L3 with a mesh that renders; there is no L3 that was not planned.",
    "What is missing is not seen, and what was not asked for confuses every later check.",
    "Make what is missing under its planned name, show what is hidden, remove or rename what was not planned.",
    _judge,
    needs_plan=True,
)
RULES = (R1,)
