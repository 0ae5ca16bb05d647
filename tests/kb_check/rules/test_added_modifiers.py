"""Trees that modifiers added by an operator lack are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
bpy.ops.wm.read_factory_settings()
"""
_ADD = "bpy.ops.object.modifier_add(type='NODES')\n"
_LAST = "bpy.context.object.modifiers[-1]"
_NEW_TREE = "bpy.data.node_groups.new('g', 'GeometryNodeTree')"
_WRONG = {
    "at once": f"{_ADD}{_LAST}.node_group.nodes",
    "by names": f"{_ADD}tree = {_LAST}.node_group\ntree.nodes['Group Input']",
    "by the modifier's name": f"{_ADD}mod = {_LAST}\nmod.name = 'Scatter'\nmod.node_group.interface",
    "by the object's name": f"obj = bpy.context.object\n{_ADD}obj.modifiers[-1].node_group.nodes",
    "the active one": f"{_ADD}bpy.context.object.modifiers.active.node_group.nodes",
    "of a new object": f"bpy.ops.mesh.primitive_plane_add()\n{_ADD}mod = {_LAST}\nmod.node_group.nodes",
    "in a function": f"def f():\n    {_ADD}    return {_LAST}.node_group.nodes\nf()",
}
_SOUND = {
    "given": f"{_ADD}mod = {_LAST}\nmod.node_group = {_NEW_TREE}\nmod.node_group.nodes",
    "asked for": f"{_ADD}tree = {_LAST}.node_group\nif tree:\n    tree.nodes",
    "made by an operator": f"{_ADD}bpy.ops.object.modifier_add(type='SUBSURF')\n{_LAST}.levels",
    "another operator": "def make():\n    mod = bpy.data.objects['Cube'].modifiers.new('a', 'NODES')\n"
    f"    setattr(mod, 'node_group', {_NEW_TREE})\nmake()\n{_LAST}.node_group.nodes",
    "of another object": f"{_ADD}other = bpy.data.objects.new('o', bpy.data.meshes.new('m'))\n"
    f"mod = other.modifiers.new('a', 'NODES')\nmod.node_group = {_NEW_TREE}\nmod.node_group.nodes",
    "caught": f"{_ADD}try:\n    {_LAST}.node_group.nodes\nexcept AttributeError:\n    pass",
    "not read from": f"{_ADD}print({_LAST}.node_group)",
}


def test_trees_that_modifiers_lack_are_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "AttributeError")
    found = {name: check("empty-pointer", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("empty-pointer", f"{_START}{code}")] == []
