"""Buffers of numpy that an array of Blender does not take: found where Blender refuses them, and mended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_MADE = """\
import bpy
import numpy as np
image = bpy.data.images.new('I', 4, 4)
color = bpy.data.materials[0].diffuse_color
mesh = bpy.data.objects['Cube'].data
"""
_BUFFERS = (
    "np.ones({0})", "np.zeros(({0},))", "np.empty({0}, dtype=float)", "np.ones({0}, dtype=np.float64)",
    "np.ones({0}, dtype=np.float32)", "np.ones({0}, np.float32)", "np.zeros({0}, dtype='f')", "[1.0] * {0}",
    "np.random.rand({0})", "np.ones({0}).astype(np.float32)", "np.ones({0}).tolist()",
)  # fmt: skip


def test_buffers_that_blender_refuses_are_found_and_mended(rule_checker: Checker, tmp_path: Path) -> None:
    made = _MADE.splitlines()
    lines = [f"image.pixels.foreach_set({buffer.format(64)})" for buffer in _BUFFERS]
    lines += [f"color.foreach_set({buffer.format(4)})" for buffer in _BUFFERS]
    lines += [f"mesh.vertices.foreach_set('co', {buffer.format(24)})" for buffer in _BUFFERS]
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    refused = [at for at, (error, *_) in enumerate(answers) if error]
    code = "\n".join([*made, *lines])
    findings = rule_checker.check(code, rules=["wrong-type"])
    assert [one.span.line - len(made) - 1 for one in findings] == refused
    assert len(refused) == 2 * 5
    mended = apply_fixes(Source(code), findings, unsafe=True).text
    left = rule_checker.check(mended, rules=["wrong-type"])
    assert len(left) == 2 * 3, "what says its type, and what is drawn at random, is left"
