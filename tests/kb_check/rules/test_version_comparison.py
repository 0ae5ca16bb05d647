"""Comparisons of Blender's version: Python refuses those that are found, and takes the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_LINES: list[str] = [
    "bpy.app.version > '4.0'",
    "bpy.app.version >= 4.0",
    "4 < bpy.app.version",
    "bpy.app.version_string >= (4, 0)",
    "bpy.app.version >= (4, 0)",
    "(4, 0) <= bpy.app.version < (9, 0, 0)",
    "bpy.app.version == '4.0'",
    "bpy.app.version_string > '4.0'",
    "bpy.app.version[0] >= 4",
]


def test_what_python_refuses_is_found_and_nothing_else(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, ["import bpy", *_LINES])
    refused = [line for line, answer in zip(_LINES, answers[1:], strict=True) if answer[0]]
    found = rule_checker.check("\n".join(["import bpy", *_LINES]), rules=["version-comparison"])
    assert [_LINES[finding.span.line - 2] for finding in found] == refused == _LINES[:4]
    fixes = [edit.text for finding in found if finding.fix for edit in finding.fix.edits]
    assert fixes == ["(4, 0, 0)", "(4, 0, 0)"]


def test_one_that_is_caught_is_no_finding(rule_checker: Checker) -> None:
    code = "import bpy\ntry:\n    bpy.app.version > '4.0'\nexcept TypeError:\n    pass\n"
    assert rule_checker.check(code, rules=["version-comparison"]) == []
