"""Angles in degrees: found where Blender keeps the number as radians, and nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MADE = """\
import bpy
import mathutils
ob = bpy.data.objects.new("a", None)
turn = mathutils.Euler((0, 0, 0))
tree = bpy.data.node_groups.new("tree", "ShaderNodeTree")
mapping = tree.nodes.new("ShaderNodeMapping")
"""
# A statement that gives an angle of 90 → what tells the angle that Blender has then.
_GIVEN = {
    "ob.rotation_euler = (90, 0, 0)": "ob.rotation_euler.x",
    "ob.rotation_euler.x = 90": "ob.rotation_euler.x",
    "ob.rotation_euler[0] = 90": "ob.rotation_euler.x",
    "ob.delta_rotation_euler = [90, 0, 0]": "ob.delta_rotation_euler.x",
    "turn = mathutils.Euler((90, 0, 0), 'XYZ')": "turn.x",
    "mapping.inputs['Rotation'].default_value = (90, 0, 0)": "mapping.inputs['Rotation'].default_value[0]",
    "bpy.ops.mesh.primitive_cube_add(rotation=(90, 0, 0))": "bpy.context.object.rotation_euler.x",
}


def test_degrees_are_kept_as_radians(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_MADE.splitlines(), *_GIVEN]
    first = len(lines) - len(_GIVEN)
    watched = dict(enumerate(_GIVEN.values(), first))
    found = check("degrees", "\n".join(lines))
    assert [one.span.line for one in found] == [place + 1 for place in watched]
    kept = run_statements(tmp_path, lines, watched)
    assert {float(after) for _, _, after in kept[first:]} == {90.0}

    text = "\n".join(lines)
    while found:  # only one of them can add the import
        text = apply_fixes(Source(text), found, unsafe=True).text
        found = check("degrees", text)
    mended = text.splitlines()
    assert mended.count("import math") == 1
    place = len(mended) - len(_GIVEN)
    kept = run_statements(tmp_path, mended, dict(enumerate(_GIVEN.values(), place)))
    assert {round(float(after), 4) for _, _, after in kept[place:]} == {1.5708}


def test_degrees_beyond_a_range_that_is_not_kept_to(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy", "camera = bpy.data.cameras.new('a')", "camera.angle = 60"]
    *_, (error, _, lens) = run_statements(tmp_path, lines, {2: "camera.lens"})
    assert (error, float(lens) < 0) == ("", True)
    [found] = check("degrees", "\n".join(lines))
    assert found.fix is not None


def test_one_number_for_three_is_not_mended(check: Check) -> None:
    [found] = check("degrees", "import bpy\nbpy.data.objects.new('a', None).rotation_euler = 90")
    assert found.fix is None


def test_functions_that_take_radians(check: Check) -> None:
    code = (
        "import mathutils\n"
        "mathutils.Matrix.Rotation(90, 4, 'X')\n"
        "mathutils.Quaternion((1, 0, 0), -45)\n"
        "mathutils.Euler((0, 0, 0)).rotate_axis('X', 180)\n"
    )
    found = check("degrees", code)
    assert [one.span.line for one in found] == [2, 3, 4]
    assert "math.radians(-45)" in found[1].message


@pytest.mark.parametrize(
    "statement",
    [
        "ob.rotation_euler = (1.5708, 0, 3)",
        "ob.rotation_euler = (5, 0, 0)",
        "ob.rotation_euler = (math.radians(90), 0, math.radians(45))",
        "ob.rotation_euler.z = math.radians(90)",
        "ob.location = (90, 0, 45)",
        "ob.scale[0] = 90",
        "ob.rotation_euler = (90, 0, angle)",
        "mathutils.Quaternion((90, 0, 0, 1))",
        "bpy.data.lights.new('l', 'SPOT').spot_size = 45",
        "mapping.inputs['Scale'].default_value = (90, 90, 90)",
    ],
)
def test_other_numbers_are_left_alone(check: Check, statement: str) -> None:
    assert not check("degrees", f"import math\n{_MADE}{statement}\n")
