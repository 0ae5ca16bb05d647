"""A parameter's name is a guess at its type: no value is refused for it, as it may be a name or a number."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_BY_NAME = {
    "col": "bpy.data.collections[col]",
    "scene": "bpy.data.scenes[scene]",
    "mat": "bpy.data.materials[mat]",
    "image": "bpy.data.images[image] if image in bpy.data.images else None",
    "obj": "bpy.data.objects.new(obj, None)",
    "mesh": "bpy.data.meshes.new(name=mesh)",
    "action": "print(action) if action is None else bpy.data.actions.get(action)",
    "armature": "[bpy.data.armatures[armature] for each in (1,) if type(armature) is str]",
}


@pytest.mark.parametrize("name", _BY_NAME)
def test_no_key_is_refused_for_a_parameters_name(rule_checker: Checker, name: str) -> None:
    code = f"import bpy\n\n\ndef find({name}):\n    return {_BY_NAME[name]}\n"
    assert rule_checker.check(code) == []


def test_no_value_is_refused_for_a_parameters_name(rule_checker: Checker) -> None:
    code = """\
import bpy


def paint(mat, row, col):
    bpy.context.object.name = mat
    bpy.data.materials[0].diffuse_color = (row, col, 1.0, 1.0)
"""
    assert rule_checker.check(code) == []


def test_what_is_surely_an_instance_is_still_refused(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [
        "import bpy",
        "mat = bpy.data.materials.new('x')",
        "bpy.data.materials[mat]",
        "bpy.data.objects.new(mat, None)",
        "bpy.data.objects['Cube'].location = (mat, 1, 1)",
    ]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check("\n".join(lines))
    assert [one.span.line for one in found] == refused == [3, 4, 5]


_SCENE = "def size(scene):\n    return scene.render.resolution\n"


@pytest.mark.parametrize(
    ("imports", "is_reported"),
    [
        ("", True),
        ("import bpy\n", True),
        ("import math\nfrom mathutils import Vector\n", True),
        ("from .ui import *\n", True),
        ("import math\n", False),
        ("from __future__ import annotations\nfrom .specs import Shape\n", False),
    ],
)
def test_a_scene_is_blenders_where_something_of_blender_is_imported(
    check: Check, imports: str, *, is_reported: bool
) -> None:
    assert bool(check("unknown-attribute", imports + _SCENE)) is is_reported


def test_what_a_setter_takes_is_not_what_the_property_gives(check: Check) -> None:
    code = """
import blf
class Label:
    def __init__(self):
        self._font = 0
    @property
    def font(self):
        return self._font
    @font.setter
    def font(self, value):
        self._font = blf.load(value)
label = Label()
label.font = "Sans"
blf.size(label.font, {size})
"""
    assert not check("wrong-type", code.format(size=12))
    assert check("wrong-type", code.format(size="'12'"))
