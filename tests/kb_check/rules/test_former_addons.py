"""Add-ons that Blender brings no more."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_LINES = [
    f"bpy.ops.preferences.addon_enable(module={name!r})"
    for name in (
        "io_scene_obj", "io_import_images_as_planes", "object_fracture_cell", "node_wrangler", "io_scene_fbx", "rigify",
    )
]  # fmt: skip


def test_what_blender_cannot_enable_is_found(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, ["import bpy", *_LINES])
    refused = [line for line, (error, *_) in zip(_LINES, answers[1:], strict=True) if error]
    assert len(refused) == 3
    found = rule_checker.check("\n".join(["import bpy", *_LINES]), rules=["former-addon"])
    assert [_LINES[finding.span.line - 2] for finding in found] == refused
    assert {finding.severity for finding in found} == {"warning"}


@pytest.mark.parametrize(
    "code",
    [
        "bpy.ops.preferences.addon_enable(module='somebodys_own')",
        "try:\n    bpy.ops.preferences.addon_enable(module='io_scene_obj')\nexcept RuntimeError:\n    pass",
        "if bpy.app.version < (4, 0):\n    bpy.ops.preferences.addon_enable(module='io_scene_obj')",
    ],
)
def test_what_may_be_there_is_no_finding(check: Check, code: str) -> None:
    assert check("former-addon", f"import bpy\n{code}\n") == []
