"""R1: what was planned is there, and nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan

pytestmark = pytest.mark.blender

SCENE = """
thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
thing("Cup", box("Mug", (0.5, 0.5, 0), (0.6, 0.6, 0.1)), box("Handle", (0.6, 0.5, 0.02), (0.65, 0.52, 0.08)))
cup, mug, handle = bpy.data.collections["Cup"], bpy.data.objects["Mug"], bpy.data.objects["Handle"]
"""
FIELD = """
wind = bpy.data.objects.new("Wind", None)
system("physics").objects.link(wind)
with bpy.context.temp_override(object=wind, active_object=wind, selected_objects=[wind]):
    bpy.ops.object.forcefield_toggle()
"""


def plan(*names: str, **roles: str) -> ScenePlan:
    objects: list[dict[str, Any]] = [
        {"name": name, "systems": ["set"], "dimensions": (1, 1, 1), "position": (0, 0, 0), "role": role}
        for name, role in {**dict.fromkeys(names, "static"), **roles}.items()
    ]
    return a_plan(objects=objects)


@pytest.mark.parametrize(
    ("more", "roles"),
    [
        ("", {}),
        ("handle.hide_render = True", {}),  # a mesh that renders is enough
        (FIELD, {"Wind": "force"}),
        (
            'grid = bpy.data.objects.new("Smoke volume", bpy.data.volumes.new("Smoke"))\nthing("Smoke", grid)',
            {"Smoke": "fluid"},
        ),
    ],
)
def test_what_is_planned_and_there_is_in_order(
    session: LiveSession, more: str, roles: dict[str, str]
) -> None:
    build(session, SCENE + more)
    assert verified(session, "R1", plan("Floor", "Cup", **roles)).passed == ("R1",)


@pytest.mark.parametrize(
    ("change", "planned", "objects", "measured", "why"),
    [
        ("", ("Floor", "Cup", "Spoon"), ("Spoon",), 0, "no L3 collection has that name"),
        ("", ("Floor",), ("Cup",), None, "not of the plan"),
        ("mug.hide_render = handle.hide_render = True", ("Floor", "Cup"), ("Cup",), 0, "hidden from renders"),
        ("cup.hide_render = True", ("Floor", "Cup"), ("Cup",), 0, "hidden from renders"),
        (
            'bpy.context.view_layer.layer_collection.children["set"].exclude = True',
            ("Floor", "Cup"), ("Cup",), 0, "hidden from renders",
        ),
        ("bpy.data.objects.remove(mug)\nbpy.data.objects.remove(handle)", ("Floor", "Cup"), ("Cup",), 0, "no mesh"),
        (
            "for one in (mug, handle):\n    one.data.clear_geometry()",
            ("Floor", "Cup"), ("Cup",), 0, "no mesh with a surface",
        ),
    ],
)  # fmt: skip
def test_what_is_missing_hidden_or_too_much_is_told(
    session: LiveSession,
    change: str,
    planned: tuple[str, ...],
    objects: tuple[str, ...],
    measured: float | None,
    why: str,
) -> None:
    build(session, SCENE + change)
    found = the_finding(verified(session, "R1", plan(*planned)))
    assert (found.rule, found.severity, found.outcome) == ("R1", "hard", "broken")
    assert (found.objects, found.measured) == (objects, measured)
    assert why in found.message


def test_a_duplicate_is_one_object_too_many(session: LiveSession) -> None:
    build(session, SCENE + 'thing("Cup.001", box("Mug.001", (0.8, 0.5, 0), (0.9, 0.6, 0.1)))')
    assert the_finding(verified(session, "R1", plan("Floor", "Cup"))).objects == ("Cup.001",)


@pytest.mark.parametrize("there", ["", 'bpy.data.objects.new("Wind", None)', FIELD.replace("Wind", "Breeze")])
def test_a_planned_field_that_does_not_blow_is_told_with_the_mechanisms(
    session: LiveSession, there: str
) -> None:
    build(session, SCENE + there)
    assert verified(session, "R1", plan("Floor", "Cup", Wind="force")).ok
    assert the_finding(verified(session, "R15", plan("Floor", "Cup", Wind="force"))).objects == ("Wind",)


def test_without_a_plan_there_is_nothing_to_judge(session: LiveSession) -> None:
    build(session, SCENE)
    assert verified(session, "R1").not_applicable == {"R1": "no plan was given"}
