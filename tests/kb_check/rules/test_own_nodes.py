"""Nodes and trees of a script's own: what they inherit, and what ``new`` makes by the names of their classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

CLASSES = """\
import bpy
class Tree(bpy.types.NodeTree):
    bl_idname = "OwnTree"
    bl_icon = "NODETREE"
    bl_label = "Own"
class Adder(bpy.types.Node):
    bl_idname = "OwnAdder"
    bl_label = "Adder"
    mode: bpy.props.EnumProperty(items=[("ADD", "Add", ""), ("SUB", "Subtract", "")])
    def init(self, context):
        self.outputs.new("NodeSocketFloat", "Out")
    def paint(self, color):
        self.color = color
for cls in (Tree, Adder):
    bpy.utils.register_class(cls)
tree = bpy.data.node_groups.new("Own", "OwnTree")
node = tree.nodes.new("OwnAdder")
same = tree.nodes.new(Adder.bl_idname)
"""
WRONG = {
    "node.mode = 'MUL'": "own-property",
    "same.mode = 'MUL'": "own-property",
    "node.color = (1, 1, 1, 1)": "wrong-type",
    "node.width = 'wide'": "wrong-type",
    "print(node.wdith)": "own-property",
    "tree.nodes.nwe('OwnAdder')": "unknown-attribute",
}
RIGHT = (
    "node.mode = 'SUB'",
    "node.color = (1, 1, 1)",
    "node.width = 200",
    "node.label = node.outputs['Out'].name",
    "node.paint((1, 0, 0))",
    "tree.links.new(node.outputs[0], same.inputs.new('NodeSocketFloat', 'In'))",
    "tree.name = 'Other'",
)


@pytest.mark.parametrize(("line", "rule"), WRONG.items())
def test_a_mistake_at_a_node_of_its_own_is_found(rule_checker: Checker, line: str, rule: str) -> None:
    assert [finding.rule for finding in rule_checker.check(f"{CLASSES}{line}\n")] == [rule]


@pytest.mark.parametrize("line", RIGHT)
def test_what_such_a_node_takes_is_no_finding(rule_checker: Checker, line: str) -> None:
    assert [finding.message for finding in rule_checker.check(f"{CLASSES}{line}\n")] == []


@pytest.mark.blender
def test_blender_says_the_same(tmp_path: Path) -> None:
    lines = [*WRONG, *RIGHT]
    done = run_statements(tmp_path, [f"{CLASSES}{line}" for line in lines])
    assert [bool(row[0]) for row in done] == [line in WRONG for line in lines]
