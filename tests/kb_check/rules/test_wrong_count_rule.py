"""Results that are unpacked into too many or too few names are reported, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CODE = """\
import addon_utils, bpy, bmesh, mathutils
from mathutils.bvhtree import BVHTree
ob = bpy.data.objects["Cube"]
scene = bpy.context.scene
depsgraph = bpy.context.evaluated_depsgraph_get()
tree = BVHTree.FromPolygons([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
kd = mathutils.kdtree.KDTree(1)
kd.balance()
bm = bmesh.new()
start, along = (0, 0, 9), (0, 0, -1)
hit, place, normal = ob.ray_cast(start, along)
hit, place, normal, index = ob.ray_cast(start, along)
hit, place, normal, index, more = ob.ray_cast(start, along)
hit, *rest = ob.ray_cast(start, along)
hit, place, normal, index, *rest = ob.ray_cast(start, along)
hit, place, normal, index, more, *rest = ob.ray_cast(start, along)
[hit, place] = ob.ray_cast(start, along)
hit, place, normal, index = scene.ray_cast(depsgraph, start, along)
hit, place, normal, index, found, matrix = scene.ray_cast(depsgraph, start, along)
hit, place = ob.closest_point_on_mesh(start)
hit, place, normal, index = ob.closest_point_on_mesh(start)
place, normal, index = tree.ray_cast(start, along)
place, normal, index, distance = tree.ray_cast(start, along)
place, normal = tree.find_nearest(start)
place, index = kd.find(start)
place, index, distance = kd.find(start)
place, rotation = ob.matrix_world.decompose()
place, rotation, scale = ob.matrix_world.decompose()
axis = angle, more = ob.matrix_world.to_quaternion().to_axis_angle()
axis, angle, more = ob.matrix_world.to_quaternion().to_axis_angle()
first, second, third = scene.camera.data.view_frame(scene=scene)
first, second, third, fourth = scene.camera.data.view_frame(scene=scene)
place, factor, more = mathutils.geometry.intersect_point_line(start, start, along)
near, far, more = mathutils.geometry.intersect_line_line(start, along, along, (0, 1, 0))
near, far = mathutils.geometry.intersect_line_line(start, along, (1, 0, 0), (0, 1, 0))
default, loaded = addon_utils.enable("cycles")
default, loaded = addon_utils.check("cycles")
near, far = mathutils.noise.noise(start)
near, far = mathutils.noise.cell_vector(start)[:2]
near, *far = mathutils.geometry.area_tri(start, along, (1, 0, 0))
found, size = ob.vertex_groups.new(name="g").add([0], 1, "ADD"), 1
key, = bmesh.ops.create_vert(bm, co=start)
faces, edges, verts = bmesh.ops.bevel(bm, geom=bm.edges[:], offset=0.1, segments=1)
"""


def test_what_cannot_be_unpacked_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_CODE.splitlines()]
    answers = run_statements(tmp_path, lines)
    refused = {place for place, (error, _, _) in enumerate(answers, start=1) if error}
    assert all("unpack" in answers[place - 1][0] for place in refused)
    assert {finding.span.line for finding in check("wrong-count", _CODE)} == refused


def test_it_is_told_once(check: Check) -> None:
    told = {finding.span.line for finding in check("wrong-count", _CODE)}
    assert told.isdisjoint(finding.span.line for finding in check("wrong-size", _CODE))


def test_what_is_there_is_named(check: Check) -> None:
    (found,) = check(
        "wrong-count", "import bpy\nhit, place, normal = bpy.context.object.ray_cast((0, 0, 9), (0, 0, -1))\n"
    )
    assert found.message == (
        "`bpy.types.Object.ray_cast` gives 4 values: `result`, `location`, `normal`, `index`. Here 3 are unpacked."
    )


@pytest.mark.parametrize(
    "code",
    [
        "try:\n    a, b = ob.ray_cast(s, d)\nexcept ValueError:\n    pass",
        "a, b = ob.ray_cast(s, d)[:2]",
        "a, b = anything.ray_cast(s, d)",
        "result = ob.ray_cast(s, d)\nresult = 1, 2\na, b = result",
        "if hasattr(ob, 'cast'):\n    a, b = ob.cast(s, d)",
    ],
)
def test_what_may_be_right_is_left_alone(check: Check, code: str) -> None:
    assert not check(
        "wrong-count", f"import bpy\nob, s, d = bpy.context.object, (0, 0, 0), (0, 0, 1)\n{code}\n"
    )
