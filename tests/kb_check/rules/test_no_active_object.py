"""What needs an active object is found where there is none: each script is run, and fails or does not."""

from __future__ import annotations

from textwrap import indent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = "import bpy\nbpy.ops.wm.read_factory_settings()\n"
_DELETE_SELECTED = "bpy.ops.object.delete()\n"
_DELETE = f"bpy.ops.object.select_all(action='SELECT')\n{_DELETE_SELECTED}"
_INNER = indent(_DELETE, "    ")
_REMOVE = "for one in list(bpy.data.objects):\n    bpy.data.objects.remove(one, do_unlink=True)\n"
_EMPTY = "bpy.ops.wm.read_factory_settings(use_empty=True)\n"
_NONE = "bpy.context.view_layer.objects.active = None\n"
_READ = "bpy.context.object.name"
_WRONG = {
    "deleted": f"{_DELETE}{_READ}",
    "deleted, also of other scenes": f"bpy.ops.object.select_all(action='SELECT')\n"
    f"bpy.ops.object.delete(use_global=True)\n{_READ}",
    "selected one by one": f"for one in bpy.data.objects:\n    one.select_set(True)\n{_DELETE_SELECTED}{_READ}",
    "removed": f"{_REMOVE}{_READ}",
    "removed of the scene": f"for one in bpy.context.scene.objects:\n    bpy.data.objects.remove(one)\n{_READ}",
    "removed of a slice": f"for one in bpy.data.objects[:]:\n    bpy.data.objects.remove(one)\n{_READ}",
    "empty file": f"{_EMPTY}{_READ}",
    "empty startup file": f"bpy.ops.wm.read_homefile(use_empty=True)\n{_READ}",
    "made none": f"{_NONE}{_READ}",
    "active_object": f"{_EMPTY}bpy.context.active_object.name",
    "of the view layer": f"{_EMPTY}bpy.context.view_layer.objects.active.name",
    "set": f"{_DELETE}bpy.context.object.name = 'x'",
    "item": f"{_DELETE}bpy.context.object['x'] = 1",
    "of a name": f"{_DELETE}ob = bpy.context.object\nprint()\nob.location.x = 1",
    "mode_set": f"{_DELETE}bpy.ops.object.mode_set(mode='OBJECT')",
    "operator of modifiers": f"{_NONE}bpy.ops.object.modifier_add(type='SUBSURF')",
    "join": f"{_EMPTY}bpy.ops.object.join()",
    "made, not active": f"{_DELETE}ob = bpy.data.objects.new('a', None)\nbpy.context.collection.objects.link(ob)\n"
    f"ob.select_set(True)\n{_READ}",
    "a mesh was made": f"import bmesh\n{_DELETE}mesh = bpy.data.meshes.new('a')\nbm = bmesh.new()\n"
    "bmesh.ops.create_cube(bm)\nbm.to_mesh(mesh)\nbm.free()\nob = bpy.data.objects.new('a', mesh)\n"
    "bpy.context.collection.objects.link(ob)\nbpy.ops.object.mode_set(mode='EDIT')",
    "in functions": f"def clear():\n{_INNER}def build():\n    {_READ}\nclear()\nbuild()",
    "data purged": f"{_DELETE}for mesh in bpy.data.meshes:\n    if not mesh.users:\n"
    "        bpy.data.meshes.remove(mesh)\n"
    f"{_READ}",
    "in a loop": f"{_DELETE}for n in range(3):\n    {_READ}",
    "only one way removes": f"{_NONE}if bpy.context.scene.frame_current > 9:\n{_INNER}{_READ}",
}
_SOUND = {
    "added": f"{_DELETE}bpy.ops.mesh.primitive_cube_add()\n{_READ}\nbpy.ops.object.mode_set(mode='OBJECT')",
    "made active": f"{_DELETE}ob = bpy.data.objects.new('a', None)\nbpy.context.collection.objects.link(ob)\n"
    f"bpy.context.view_layer.objects.active = ob\n{_READ}",
    "added by a function": f"def add():\n    bpy.ops.mesh.primitive_cube_add()\n{_EMPTY}add()\n{_READ}",
    "added in a loop": f"{_EMPTY}for n in range(2):\n    bpy.ops.mesh.primitive_cube_add()\n    {_READ}",
    "added while it is assigned": "def add():\n    bpy.ops.mesh.primitive_cube_add()\n    return 'a'\n"
    f"{_EMPTY}bpy.context.object.name = add()",
    "deselected only": f"bpy.ops.object.select_all(action='DESELECT')\nbpy.ops.object.delete()\n{_READ}",
    "some are deleted": "bpy.data.objects['Light'].select_set(True)\nbpy.data.objects['Cube'].select_set(False)\n"
    f"bpy.ops.object.delete()\n{_READ}",
    "some are selected": "for one in bpy.data.objects:\n    one.select_set(one.type != 'MESH')\n"
    f"{_DELETE_SELECTED}{_READ}",
    "some are removed": "for one in bpy.data.objects:\n    if one.type != 'MESH':\n"
    "        bpy.data.objects.remove(one)\n"
    f"{_READ}",
    "asked": f"{_DELETE}if bpy.context.object:\n    {_READ}\nob = bpy.context.object\nif ob is not None:\n    ob.name",
    "asked with and": f"{_DELETE}bpy.context.object and {_READ}",
    "asked in a function": f"def name():\n    if bpy.context.active_object is None:\n        return ''\n"
    f"    return {_READ}\n{_DELETE}name()",
    "asked for the mode": f"{_DELETE}if bpy.context.mode != 'OBJECT':\n    bpy.ops.object.mode_set(mode='OBJECT')",
    "asked for the operator": f"{_DELETE}if bpy.ops.object.mode_set.poll():\n"
    "    bpy.ops.object.mode_set(mode='OBJECT')",
    "asked by a name": f"{_DELETE}selected = bpy.context.selected_objects\nif selected:\n    {_READ}",
    "loop over what is there": f"{_DELETE}for one in bpy.data.objects:\n    {_READ}\n"
    f"for one in bpy.context.selected_objects:\n    {_READ}",
    "while one is there": f"{_DELETE}while bpy.context.object:\n    {_READ}",
    "caught": f"{_DELETE}try:\n    bpy.ops.object.mode_set(mode='OBJECT')\n    {_READ}\nexcept RuntimeError:\n    pass",
    "given": "ob = bpy.data.objects['Cube']\n"
    f"{_NONE}with bpy.context.temp_override(object=ob, active_object=ob):\n"
    "    bpy.context.object.name\n    bpy.ops.object.modifier_add(type='SUBSURF')",
    "needs none": f"{_DELETE}bpy.ops.object.select_all(action='SELECT')\nbpy.ops.object.shade_smooth()\n"
    "bpy.ops.object.transform_apply()\nbpy.ops.object.duplicate()",
    "startup file": f"{_EMPTY}bpy.ops.wm.read_factory_settings()\n{_READ}",
    "only passed on": f"{_DELETE}print(bpy.context.object)\nob = bpy.context.object\nprint(ob)",
    "in a condition": f"if bpy.context.scene.frame_current > 9:\n{_INNER}{_READ}",
    "before": f"{_READ}\n{_DELETE}",
    "by another function": f"def later():\n    {_READ}\nlater()\n{_DELETE}",
}


@pytest.mark.parametrize("name", _WRONG)
def test_what_lacks_an_active_object_is_found(check: Check, name: str) -> None:
    findings = check("no-active-object", f"{_START}{_WRONG[name]}\n")
    expected = "warning" if "object.delete(" in _WRONG[name] and _NONE not in _WRONG[name] else "error"
    assert [finding.severity for finding in findings] == [expected]


def test_blender_refuses_each(tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    assert [name for name, (error, *_) in zip(_WRONG, answers, strict=True) if not error] == []


@pytest.mark.parametrize("name", _SOUND)
def test_what_runs_has_no_finding(check: Check, name: str) -> None:
    assert check("no-active-object", f"{_START}{_SOUND[name]}\n") == []


def test_blender_runs_each(tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []


def test_a_hidden_object_stays_active(check: Check, tmp_path: Path) -> None:
    hidden = f"{_START}bpy.context.object.hide_set(True)\n{_DELETE}{_READ}"
    assert run_statements(tmp_path, [hidden])[0][0] == ""
    assert [finding.severity for finding in check("no-active-object", hidden)] == ["warning"]


def test_what_follows_is_read_as_if_it_ran(check: Check) -> None:
    code = f"{_START}{_DELETE}bpy.ops.object.mode_set(mode='EDIT')\nbpy.ops.mesh.subdivide()\n"
    assert len(check("no-active-object", code)) == 1
    assert check("wrong-mode", code) == []
