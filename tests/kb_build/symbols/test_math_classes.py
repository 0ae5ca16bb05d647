"""Which arrays are values of mathutils, as Blender itself gives them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_build.symbols.math_classes import math_class, math_class_of

if TYPE_CHECKING:
    from pathlib import Path

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


# Subtype and size of a vector that a script declares.
_DECLARED = [
    ("QUATERNION", 4), ("QUATERNION", 3), ("EULER", 3), ("EULER", 4), ("XYZ", 3), ("XYZ", 2), ("XYZ", 5), ("NONE", 3),
    ("TRANSLATION", 3), ("AXISANGLE", 4), ("COLOR", 3), ("COLOR", 4), ("COLOR_GAMMA", 3), ("MATRIX", 16),
    ("MATRIX", 9), ("MATRIX", 12), ("MATRIX", (4, 4)), ("MATRIX", (2, 3)), ("XYZ", (3, 3)),
]  # fmt: skip
_OF_DECLARED = """
import bpy, json, sys
with open(sys.argv[-1]) as file:
    given = json.load(file)
declared = {
    f"n{at}": bpy.props.FloatVectorProperty(subtype=subtype, size=size)
    for at, (subtype, size) in enumerate(given)
}
group = type("Group", (bpy.types.PropertyGroup,), {"__annotations__": declared})
bpy.utils.register_class(group)
bpy.types.Scene.group = bpy.props.PointerProperty(type=group)
with open(sys.argv[-1], "w") as file:
    json.dump([type(getattr(bpy.context.scene.group, name)).__name__ for name in declared], file)
"""


def test_what_a_script_declares_is_what_blender_makes_of_it(tmp_path: Path) -> None:
    made = told_by_blender(_OF_DECLARED, tmp_path, _DECLARED)
    told = [
        math_class_of(subtype, size if isinstance(size, tuple) else (size,)).rpartition(".")[2]
        for subtype, size in _DECLARED
    ]
    assert told == ["" if name == "bpy_prop_array" else name for name in made]
