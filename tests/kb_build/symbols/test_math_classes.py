"""Which arrays are values of mathutils, as Blender itself gives them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_build.symbols.math_classes import math_class

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_EXPRESSIONS = {
    "bpy.types.Object.color": "bpy.data.objects['Cube'].color",
    "bpy.types.Object.dimensions": "bpy.data.objects['Cube'].dimensions",
    "bpy.types.Object.matrix_world": "bpy.data.objects['Cube'].matrix_world",
    "bpy.types.Object.rotation_axis_angle": "bpy.data.objects['Cube'].rotation_axis_angle",
    "bpy.types.Object.rotation_quaternion": "bpy.data.objects['Cube'].rotation_quaternion",
    "bpy.types.Object.rotation_euler": "bpy.data.objects['Cube'].rotation_euler",
    "bpy.types.Object.bound_box": "bpy.data.objects['Cube'].bound_box",
    "bpy.types.Light.color": "bpy.data.lights['Light'].color",
    "bpy.types.Material.diffuse_color": "bpy.data.materials['Material'].diffuse_color",
    "bpy.types.Keyframe.co": "fcurve.keyframe_points[0].co",
    "bpy.types.Keyframe.handle_left": "fcurve.keyframe_points[0].handle_left",
}
_ASKED = """
import bpy, json, sys
fcurve = bpy.data.objects['Cube'].driver_add('location', 0)
fcurve.keyframe_points.add(1)
with open(sys.argv[-1]) as file:
    given = json.load(file)
with open(sys.argv[-1], "w") as file:
    json.dump([type(eval(text)).__name__ for text in given], file)
"""


@pytest.fixture(scope="module")
def given_by_blender(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    names = told_by_blender(_ASKED, tmp_path_factory.mktemp("classes"), list(_EXPRESSIONS.values()))
    return dict(zip(_EXPRESSIONS, names, strict=True))


@pytest.mark.parametrize("path", _EXPRESSIONS)
def test_arrays_are_what_blender_makes_of_them(
    path: str, kb: KnowledgeBase, given_by_blender: dict[str, str]
) -> None:
    symbol = kb.reader.symbol(path)
    assert symbol is not None
    name = given_by_blender[path]
    assert math_class(symbol) == ("" if name == "bpy_prop_array" else f"mathutils.{name}")
