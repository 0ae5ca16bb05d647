"""Modifiers and constraints by the names that Blender gives new ones, and by others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements
from told_by_blender import told_by_blender

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

# Holder → for each type: its label, and what one is called that gets no name.
_ASK = """
import json, sys
import bpy

def named(holder, cls, make):
    for item in cls.bl_rna.properties["type"].enum_items:
        try:
            made = make(holder, item.identifier)
        except Exception:
            continue
        if made:
            yield item.identifier, item.name, made.name
            holder.remove(made)

mesh = bpy.data.objects["Cube"]
pencil = bpy.data.objects.new("pencil", bpy.data.grease_pencils.new("pencil"))
armature = bpy.data.objects.new("armature", bpy.data.armatures.new("armature"))
bpy.context.collection.objects.link(armature)
bpy.context.view_layer.objects.active = armature
bpy.ops.object.mode_set(mode='EDIT')
armature.data.edit_bones.new("bone").tail = 0, 0, 1
bpy.ops.object.mode_set(mode='OBJECT')
found = {
    "modifiers": [
        row
        for ob in (mesh, pencil)
        for row in named(ob.modifiers, bpy.types.Modifier, lambda held, kind: held.new("", kind))
    ],
    "constraints": [
        row
        for held in (mesh.constraints, armature.pose.bones[0].constraints)
        for row in named(held, bpy.types.Constraint, lambda held, kind: held.new(kind))
    ],
}
open(sys.argv[-1], "w").write(json.dumps(found))
"""
_CODE = """\
import bpy
ob = bpy.context.object
bpy.ops.object.modifier_add(type='NODES')
bpy.ops.object.modifier_add(type='SUBSURF')
bpy.ops.object.modifier_add(type='BEVEL')
track = ob.constraints.new('TRACK_TO')
ob.modifiers["Geometry Nodes"]
ob.modifiers["GeometryNodes"]
ob.modifiers["Subdivision Surface"].levels = 2
bpy.context.object.modifiers["Subsurf"].levels = 2
ob.modifiers["Subdivision"].levels = 2
ob.modifiers["Bevel"]
ob.constraints["TrackTo"]
ob.constraints["Track To"].influence = 0.5
action = bpy.data.actions.new("action")
slot = action.slots.new(id_type='OBJECT', name="Cube")
action.slots["OBCube"]
action.slots["Cube"]
"""


def test_names_are_those_that_blender_gives(rule_checker: Checker, tmp_path: Path) -> None:
    found: dict[str, list[tuple[str, str, str]]] = told_by_blender(_ASK, tmp_path)
    names_of_new = rule_checker.names.names_of_new
    asked = [
        (holder, asked, choice, name)
        for holder in found
        for choice, label, name in found[holder]
        for asked in {choice, label} - {name}
    ]
    told = [(one, meant) for one in asked if (meant := names_of_new.meant(*one[:2]))]
    wrong = [one for one, meant in told if meant.choice == one[2] and meant.name != one[3]]
    assert wrong == []
    assert len(told) > 0.9 * len(asked) > 90


def test_names_that_new_ones_do_not_have_are_told_and_mended(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_CODE.splitlines()]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = check("default-name", _CODE)
    assert [one.span.line for one in found] == refused == [7, 9, 10, 13, 18]
    mended: list[str] = apply_fixes(Source(_CODE), found, unsafe=True).text.splitlines()[:-1]
    assert [error for error, *_ in run_statements(tmp_path, mended) if error] == []


@pytest.mark.parametrize(
    "between",
    [
        "ob.modifiers[-1].name = 'Subsurf'",
        "if 'Subsurf' in ob.modifiers: pass",
        "setattr(ob.modifiers[-1], other, name)",
        "from . import others",
    ],
)
def test_names_that_something_may_have_are_left_alone(check: Check, between: str) -> None:
    start = "import bpy\nob = bpy.context.object\nbpy.ops.object.modifier_add(type='SUBSURF')\n"
    asked = "ob.modifiers['Subsurf'].levels = 2\n"
    assert len(check("default-name", start + asked)) == 1
    assert not check("default-name", f"{start}{between}\n{asked}")
    assert not check("default-name", start.replace("SUBSURF", "BEVEL") + asked)
