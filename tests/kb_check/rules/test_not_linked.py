"""Objects that a new collection does not have are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
bpy.ops.wm.read_factory_settings()
obj = bpy.data.objects["Cube"]
"""
_NEW = "col = bpy.data.collections.new('c')\n"
_UNLINK = "col.objects.unlink(obj)"
_SCENE = "bpy.context.scene.collection.children.link(col)\n"
_WRONG = {
    "at once": f"{_NEW}{_UNLINK}",
    "as a child": f"{_NEW}{_SCENE}col.hide_render = True\n{_UNLINK}",
    "in a loop": f"{_NEW}for obj in bpy.context.selected_objects:\n    {_UNLINK}",
    "in a function": f"def f(obj):\n    {_NEW}    {_SCENE}    {_UNLINK}\nf(obj)",
    "before it is linked": f"{_NEW}{_SCENE}{_UNLINK}\ncol.objects.link(obj)",
}
_SOUND = {
    "linked before": f"{_NEW}col.objects.link(obj)\n{_UNLINK}",
    "linked by another name": f"{_NEW}same = col\nsame.objects.link(obj)\n{_UNLINK}",
    "linked by a function": f"{_NEW}def put():\n    col.objects.link(obj)\nput()\n{_UNLINK}",
    "linked in the loop": f"{_NEW}for one in bpy.context.selected_objects:\n    col.objects.link(one)\n"
    "    col.objects.unlink(one)",
    "added by an operator": f"{_NEW}{_SCENE}"
    "bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children['c']\n"
    f"bpy.ops.mesh.primitive_cube_add()\nobj = bpy.context.object\n{_UNLINK}",
    "another one": f"{_NEW}col = bpy.data.collections['Collection']\n{_UNLINK}",
    "caught": f"{_NEW}try:\n    {_UNLINK}\nexcept RuntimeError:\n    pass",
}


def test_what_is_not_linked_is_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "RuntimeError")
    found = {name: check("not-linked", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("not-linked", f"{_START}{code}")] == []
