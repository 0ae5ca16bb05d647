"""Fixes say how far to move an object, and following them removes the finding."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from scenes import a_plan, build, the_finding, verified

from agents.protocol.judging.move_advice import describe_move

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan

FLOOR = 'thing("Floor", box("Ground", (-5, -5, -0.5), (5, 5, 0)), system_name="ground")\n'
CRATE = 'crate = box("Planks", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), at=({}, 0, {}){})\nthing("Crate", crate)\n'
TOUCHES = 'crate["contact_with"] = "Ground"\n'
_SIDES = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1)}


@pytest.mark.parametrize(
    ("way", "words"),
    [
        ((0, 0, -0.005), "Move 'A' 5.0 mm down (−Z)"),
        ((0, 0, 0.0123), "Move 'A' 12.3 mm up (+Z)"),
        ((-0.1, 1e-6, 0), "Move 'A' 100.0 mm along −X"),
        ((0.01, -0.02, 1e-6), "Move 'A' by (+10.0, −20.0, 0) mm"),
    ],
)
def test_a_way_along_an_axis_is_told_by_its_side(way: tuple[float, float, float], words: str) -> None:
    assert describe_move("A", way) == words


def way_told(fix: str) -> tuple[str, list[float]]:
    """(what is to be moved, by how much in metres) as a fix says it."""
    name = re.search(r"Move '([^']+)'", fix)
    assert name is not None, fix
    fix = fix.replace("−", "-")
    if along := re.search(r"([\d.]+) mm (?:up|down|along)[^XYZ]*([+-])([XYZ])", fix):
        length = float(along[1]) / 1000 * (1 if along[2] == "+" else -1)
        return name[1], [length * part for part in _SIDES[along[3]]]
    by = re.search(r"by \(([^)]+)\) mm", fix)
    assert by is not None, fix
    return name[1], [float(part) / 1000 for part in by[1].split(",")]


MENDED: dict[str, tuple[str, str, ScenePlan | None]] = {
    "a crate above its floor": ("V1", CRATE.format(0, 0.03, "") + TOUCHES, None),
    "a crate beside its floor": ("V1", CRATE.format(5.15, 0.02, "") + TOUCHES, None),
    "a turned crate above its floor": (
        "V1",
        CRATE.format(0, 0.2, ", turn=(30, 20, 10)") + TOUCHES,
        None,
    ),
    "a crate in its floor": ("V2", CRATE.format(0, -0.03, ""), None),
    "a crate in its floor's side": ("V2", CRATE.format(5.06, -0.3, ""), None),
    "a turned crate in its floor": ("V2", CRATE.format(0, -0.05, ", turn=(30, 20, 10)"), None),
    "a crate off what it leans on": (
        "R6",
        'box_of = box("Wall side", (0.2, -2, 0), (0.3, 2, 2))\nthing("Wall", box_of)\n' + CRATE.format(0, 0, ""),
        a_plan({"kind": "StableAgainst", "child": "Crate", "parent": "Wall"}),
    ),
    "a crate that floats": (
        "R5",
        CRATE.format(0, 0.03, ""),
        a_plan({"kind": "SupportedBy", "child": "Crate", "parents": ("Floor",)}),
    ),
}  # fmt: skip


@pytest.mark.blender
@pytest.mark.parametrize(("rule", "script", "plan"), MENDED.values(), ids=MENDED)
def test_what_is_moved_as_told_is_mended(
    session: LiveSession, rule: str, script: str, plan: ScenePlan | None
) -> None:
    build(session, FLOOR + script)
    name, way = way_told(the_finding(verified(session, rule, plan)).fix)
    assert name in {"Crate", "Planks"}
    session.run(
        'one = bpy.data.objects["Planks"]\n'
        f"one.matrix_world.translation += __import__('mathutils').Vector({way})\n"
        "bpy.context.view_layer.update()"
    )
    assert verified(session, rule, plan).passed == (rule,)


def test_nothing_is_told_to_move_by_more_than_half_its_size(session: LiveSession) -> None:
    build(session, FLOOR + CRATE.format(0, 1, ""))
    (finding,) = verified(
        session, "R5", a_plan({"kind": "SupportedBy", "child": "Crate", "parents": ("Floor",)})
    ).findings
    assert "1000.0 mm above" in finding.message
    assert "1000" not in finding.fix


def test_a_plant_in_an_open_compartment_of_a_bookcase_is_on_its_board(session: LiveSession) -> None:
    """Boards that meet flush, in one mesh of several closed shells, some of them inside out."""
    build(
        session,
        """
shape = bmesh.new()
for number, (low, high) in enumerate([
    ((-0.4, -0.15, 0), (-0.38, 0.15, 1)), ((0.38, -0.15, 0), (0.4, 0.15, 1)), ((-0.38, 0.14, 0), (0.38, 0.15, 1)),
    ((-0.38, -0.15, 0), (0.38, 0.14, 0.02)), ((-0.38, -0.15, 0.4), (0.38, 0.14, 0.42)),
    ((-0.38, -0.15, 0.98), (0.38, 0.14, 1)),
]):
    corners = bmesh.ops.create_cube(shape, size=1)["verts"]
    for corner in corners:
        corner.co = Vector([low[i] + (corner.co[i] + 0.5) * (high[i] - low[i]) for i in range(3)])
    if number % 2:
        bmesh.ops.reverse_faces(shape, faces=list({face for corner in corners for face in corner.link_faces}))
data = bpy.data.meshes.new("Boards")
shape.to_mesh(data)
thing("Bookcase", bpy.data.objects.new("Boards", data))
thing("Plant", lathe("Pot", [(0, 0), (0.06, 0), (0.1, 0.3), (0, 0.3)], at=(0.1, 0, 0.42)), at=(0.1, 0, 0.42))
""",
    )
    plan = a_plan({"kind": "SupportedBy", "child": "Plant", "parents": ("Bookcase",)})
    assert verified(session, "V2,R5", plan).passed == ("V2", "R5")
    assert verified(session, "V2").passed == ("V2",)
