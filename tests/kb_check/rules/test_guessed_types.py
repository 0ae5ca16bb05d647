"""A parameter's name is a guess at its type: no value is refused for it, as it may be a name or a number."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_BY_NAME = {
    "col": "bpy.data.collections[col]",
    "scene": "bpy.data.scenes[scene]",
    "mat": "bpy.data.materials[mat]",
    "image": "bpy.data.images[image] if image in bpy.data.images else None",
    "obj": "bpy.data.objects.new(obj, None)",
    "mesh": "bpy.data.meshes.new(name=mesh)",
    "action": "setattr(bpy.data, 'x', action) if action is None else bpy.data.actions.get(action)",
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
