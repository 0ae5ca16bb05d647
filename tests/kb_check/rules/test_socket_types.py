"""Types of sockets of a group's interface: Blender refuses those that are found, and takes what is told instead."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_START = "import bpy\ntree = bpy.data.node_groups.new('G', 'GeometryNodeTree')\n"
_NEW = "tree.interface.new_socket(name='A', in_out='INPUT', socket_type={!r})"
_TYPES = {
    "FLOAT": "NodeSocketFloat", "VALUE": "NodeSocketFloat", "INT": "NodeSocketInt", "BOOLEAN": "NodeSocketBool",
    "VECTOR": "NodeSocketVector", "RGBA": "NodeSocketColor", "GEOMETRY": "NodeSocketGeometry",
    "STRING": "NodeSocketString", "OBJECT": "NodeSocketObject", "Float": "NodeSocketFloat",
}  # fmt: skip


def test_a_type_is_no_class(rule_checker: Checker, tmp_path: Path) -> None:
    lines: list[str] = [_NEW.format(one) for pair in _TYPES.items() for one in pair]
    answers = run_statements(tmp_path, [_START, *lines])
    assert [bool(answer[0]) for answer in answers] == [False, *[True, False] * len(_TYPES)]
    found = rule_checker.check(_START + "\n".join(lines), rules=["unknown-node", "unknown-value"])
    assert [finding.span.line for finding in found] == [3 + 2 * at for at in range(len(_TYPES))]
    edits = [edit.text.strip("'\"") for finding in found if finding.fix for edit in finding.fix.edits]
    assert edits == list(_TYPES.values())
