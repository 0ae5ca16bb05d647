"""Bones that are used in a mode in which there are none are found: each script is run, and fails or does not."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements
from whole import by_turns

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MADE = """\
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
arm = bpy.data.armatures.new("Rig")
rig = bpy.data.objects.new("Rig", arm)
bpy.context.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
"""
_ADDED = """\
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.object.armature_add(enter_editmode=True)
rig = bpy.context.object
"""
_EDIT = "bpy.ops.object.mode_set(mode='EDIT')\n"
_LEFT = "bpy.ops.object.mode_set(mode='OBJECT')\n"
_BONE = "eb = arm.edit_bones.new('b')\neb.tail = (0, 0, 1)\n"
_START = f"{_MADE}{_EDIT}{_BONE}"
_HELPER = """\
def bone(name, parent=None):
    new = arm.edit_bones.new(name)
    new.tail = (0, 0, 1)
    if parent:
        new.parent = parent
    return new
"""
_ACTIVATED = """\
other = bpy.data.objects.new('Other', {})
bpy.context.collection.objects.link(other)
bpy.context.view_layer.objects.active = other
"""
_WRONG = {
    "set": f"{_START}{_LEFT}eb.head = (0, 0, 1)",
    "set in Pose Mode": f"{_START}bpy.ops.object.mode_set(mode='POSE')\neb.roll = 1",
    "toggled": f"{_MADE}bpy.ops.object.editmode_toggle()\n{_BONE}bpy.ops.object.editmode_toggle()\neb.tail = (0, 0, 2)",
    "by key": f"{_START}bone = rig.data.edit_bones['b']\n{_LEFT}bone.head = (0, 0, 1)",
    "by a helper": f"{_MADE}{_HELPER}{_EDIT}hip = bone('hip')\nshin = bone('shin', hip)\n{_LEFT}shin.roll = 1",
    "in a function": f"{_MADE}def f():\n    {_EDIT}    eb = arm.edit_bones.new('b')\n    {_LEFT}    eb.roll = 1\nf()",
    "pose bone": f"{_START}rig.pose.bones['b'].rotation_mode = 'XYZ'",
    "bone": f"{_START}arm.bones['b'].use_deform = False",
    "data of the active object": f"{_START}bpy.context.object.data.bones['b'].use_deform = False",
    "names of parts": f"{_MADE}{_EDIT}bones = rig.data.edit_bones\nbones.new('b').tail = (0, 0, 1)\n"
    "posed = rig.pose.bones\nposed['b'].location.x = 1",
    "added": f"{_ADDED}eb = rig.data.edit_bones.new('b')\neb.tail = (0, 0, 1)\nrig.data.bones['b']",
    "never edited": f"{_MADE}arm.edit_bones.new('b')",
    "edited before": f"{_START}{_LEFT}arm.edit_bones.new('c')",
    "edited before, by the object": f"{_START}{_LEFT}rig.data.edit_bones['b']",
    "in a loop": f"{_MADE}for name in 'ab':\n    arm.edit_bones.new(name)",
    "added, not edited": f"{_ADDED.replace('enter_editmode=True', '')}rig.data.edit_bones[0]",
    "added, set": f"{_ADDED}eb = rig.data.edit_bones['Bone']\n{_LEFT}eb.tail = (0, 0, 2)",
}
# What becomes of these is chance: their memory is free, and may hold what it held.
_OF_FREE_MEMORY = [
    f"{_START}{_LEFT}print(eb.name)",
    f"{_START}{_LEFT}eb['limb'] = 1",
    f"{_START}{_LEFT}if eb.parent:\n    pass",
    f"{_START}{_LEFT}{_EDIT}eb.head = (0, 0, 1)",
]
_SOUND = {
    "in order": f"{_START}eb.roll = 1\n{_LEFT}arm.bones['b'].use_deform = False\nrig.pose.bones['b'].location.x = 1",
    "got anew": f"{_START}{_LEFT}{_EDIT}eb = arm.edit_bones['b']\neb.roll = 1\n{_LEFT}eb = arm.bones['b']\neb.name",
    "still in Edit Mode": f"{_START}{_EDIT}eb.roll = 1",
    "value kept": f"{_START}name = eb.name\nhead = eb.head.copy()\n{_LEFT}rig.pose.bones[name]\nhead.x = 1",
    "of the armature": f"{_START}{_LEFT}eb.id_data.name\neb.bl_rna\nprint(eb is None)",
    "second time": f"{_START}{_LEFT}{_EDIT}arm.edit_bones.new('c').tail = (1, 0, 1)\nrig.pose.bones['b']",
    "same name again": f"{_START}{_LEFT}{_EDIT}arm.edit_bones.new('b').tail = (1, 0, 1)\narm.bones['b']",
    "brought up to date": f"{_START}rig.update_from_editmode()\narm.bones['b']",
    "edited by a helper": f"{_MADE}def edit():\n    {_EDIT}edit()\n{_BONE}",
    "edited in a loop": f"{_MADE}for name in 'ab':\n    {_EDIT}    arm.edit_bones.new(name)",
    "asked for bones": f"{_MADE}arm.edit_bones.get('b')\nlen(arm.edit_bones)",
    "edited after all": f"{_MADE}{_EDIT}{_LEFT}{_EDIT}{_BONE}",
    "another is active": f"{_START}{_ACTIVATED.format(None)}"
    "try:\n    bpy.ops.object.mode_set(mode='OBJECT')\nexcept RuntimeError:\n    pass\neb.roll = 1",
    "two are edited": f"{_START}mesh = bpy.data.meshes.new('Sheet')\n{_ACTIVATED.format('mesh')}{_EDIT}"
    f"bone = arm.edit_bones['b']\n{_LEFT}bone.roll = 1\neb.roll = 1",
    "of another armature": f"{_START}{_LEFT}new = bpy.data.armatures.new('New')\n{_ACTIVATED.format('new')}"
    f"{_EDIT}new.edit_bones.new('b').tail = rig.pose.bones['b'].tail\narm.bones['b']",
    "the operator's own": f"{_ADDED.replace('enter_editmode=True', '')}"
    f"{_EDIT}rig.data.edit_bones.new('Bone').tail = (0, 0, 1)\nrig.pose.bones['Bone']",
    "caught": f"{_START}try:\n    arm.bones['b']\nexcept KeyError:\n    pass",
    "asked": f"{_START}{_LEFT}print(eb.roll if rig.mode == 'EDIT' else arm.bones['b'].name)",
    "in a condition": f"{_START}if False:\n    {_LEFT}eb.roll = 1",
}


@pytest.mark.parametrize("name", by_turns(_WRONG, every=4))
def test_what_is_found_fails_in_blender(name: str, tmp_path: Path) -> None:
    """Each in a Blender of its own, of which `make test` starts a few."""
    done = subprocess.run(
        [sys.executable, "-P", "-c", _WRONG[name]],
        cwd=tmp_path,
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert done.returncode != 0


@pytest.mark.parametrize("name", _WRONG)
def test_what_fails_is_found_once(check: Check, name: str) -> None:
    found = check("bones-by-mode", _WRONG[name])
    assert [finding.severity for finding in found] == ["error"]


@pytest.mark.parametrize("code", _OF_FREE_MEMORY)
def test_what_reads_or_writes_free_memory_is_found(check: Check, code: str) -> None:
    assert len(check("bones-by-mode", code)) == 1


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, list[str](_SOUND.values()))
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("bones-by-mode", code)] == []
