"""Sockets that built-in nodes do not take are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
tree = bpy.data.node_groups.new("t", "ShaderNodeTree")
nodes = tree.nodes
"""
_WRONG = {
    "an output": "node = nodes.new('ShaderNodeRGB')\nnode.outputs.new('NodeSocketColor', 'x')",
    "an input": "nodes.new('ShaderNodeMath').inputs.new('NodeSocketFloat', 'x')",
    "of a group": "node = nodes.new('ShaderNodeGroup')\nnode.inputs.new('NodeSocketFloat', 'x')",
    "of a group's own": "node = nodes.new('NodeGroupInput')\nnode.outputs.new('NodeSocketFloat', 'x')",
    "all taken": "node = nodes.new('ShaderNodeMath')\nnode.inputs.clear()",
    "one taken": "node = nodes.new('ShaderNodeMath')\nnode.inputs.remove(node.inputs[0])",
    "moved": "node = nodes.new('ShaderNodeMath')\nnode.inputs.move(0, 1)",
}
_SOUND = {
    "of a script node": "nodes.new('ShaderNodeScript').inputs.new('NodeSocketFloat', 'x')",
    "of a tree": "tree.interface.new_socket('x', in_out='INPUT')",
    "of an own node": "class N(bpy.types.Node):\n    bl_idname = bl_label = 'N'\n    def init(self, context):\n"
    "        self.inputs.new('NodeSocketFloat', 'x')\n        self.outputs.new('NodeSocketFloat', 'y')\n"
    "bpy.utils.register_class(N)\nnode = nodes.new('N')\nassert len(node.inputs) == 1\n"
    "node.inputs.new('NodeSocketFloat', 'z')\nbpy.utils.unregister_class(N)",
    "of any node": "def add(node):\n    node.inputs.new('NodeSocketFloat', 'x')\nadd(nodes.new('ShaderNodeScript'))",
    "caught": "try:\n    nodes.new('ShaderNodeRGB').inputs.new('NodeSocketFloat', 'x')\nexcept RuntimeError:\n    pass",
    "links": "node = nodes.new('ShaderNodeMath')\ntree.links.new(node.outputs[0], node.inputs[0])",
}


def test_sockets_that_are_not_taken_are_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "RuntimeError")
    found = {name: check("fixed-sockets", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("fixed-sockets", f"{_START}{code}")] == []
