"""Objects that are used before they are in a collection are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
layer = bpy.context.view_layer
objects = bpy.context.collection.objects
other = bpy.data.objects.new("other", None)
objects.link(other)
ob = bpy.data.objects.new("ob", None)
"""
_SELECT = "ob.select_set(True)"
_LINK = "objects.link(ob)\n"
_WRONG = {
    "selected": _SELECT,
    "selected by keyword": "ob.select_set(state=True)",
    "active": "bpy.context.view_layer.objects.active = ob",
    "active of a name": "layer.objects.active = ob",
    "hidden": "ob.hide_set(True)",
    "linked later": f"{_SELECT}\n{_LINK}",
    "set meanwhile": f"ob.location = (1, 2, 3)\nob.parent = other\nprint(len(ob.name))\n{_SELECT}",
    "pointed to": f"other.parent = ob\n{_SELECT}",
    "another is linked": f"new = bpy.data.objects.new('new', None)\nobjects.link(new)\n{_SELECT}",
    "copy": f"{_LINK}twin = ob.copy()\ntwin.select_set(True)",
    "in a function": "def f():\n    ob = bpy.data.objects.new('ob', None)\n    ob.select_set(True)\nf()",
}
_SOUND = {
    "linked": f"{_LINK}{_SELECT}\nlayer.objects.active = ob",
    "not selected": "ob.select_set(False)\nob.hide_set(False)",
    "linked by a helper": f"def link(which):\n    objects.link(which)\nlink(ob)\n{_SELECT}",
    "linked out of sight": f"def link():\n    objects.link(ob)\nlink()\n{_SELECT}",
    "linked as one of all": "for one in bpy.data.objects:\n    if one != other:\n        objects.link(one)\n"
    f"{_SELECT}",
    "linked from a list": f"made = [ob]\nobjects.link(made[0])\n{_SELECT}",
    "linked as a parent": f"other.parent = ob\nup = other.parent\nobjects.link(up)\n{_SELECT}",
    "linked in a condition": f"if ob.name:\n    {_LINK}{_SELECT}",
    "caught": f"try:\n    {_SELECT}\nexcept RuntimeError:\n    pass",
    "another name": f"{_LINK}ob, new = other, bpy.data.objects.new('new', None)\n{_SELECT}",
    "camera of the scene": "bpy.context.scene.camera = ob",
}


def test_what_is_in_no_collection_is_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "RuntimeError")
    found = {name: check("unlinked-object", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("unlinked-object", f"{_START}{code}")] == []
