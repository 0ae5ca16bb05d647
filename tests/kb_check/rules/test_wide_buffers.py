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


_FLOATS = (
    "np.ones({0})", "np.zeros({0}, dtype=np.float32)", "np.zeros({0}, dtype=float)", "[1.0] * {0}",
    "[0.5 for each in range({0})]",
)  # fmt: skip
_WHOLE = (
    "np.ones({0}, dtype=int)", "np.zeros({0}, dtype=np.int32)", "[1] * {0}", "[0 for each in range({0})]",
    "np.ones({0}).astype(int)",
)  # fmt: skip
_PLACES = {
    "mesh.polygons.foreach_set('use_smooth', {})": 6,
    "mesh.polygons.foreach_set('material_index', {})": 6,
    "mesh.edges.foreach_set('vertices', {})": 24,
}


def test_floats_for_what_takes_none_are_found_and_mended(rule_checker: Checker, tmp_path: Path) -> None:
    made = _MADE.replace("bpy.data.objects['Cube'].data", "bpy.data.meshes['Cube']").splitlines()
    lines = [
        line.format(buffer.format(count)) for line, count in _PLACES.items() for buffer in (*_FLOATS, *_WHOLE)
    ]
    lines += [line.replace("_set", "_get").format(f"np.ones({count})") for line, count in _PLACES.items()]
    lines += [f"try:\n    {lines[0]}\nexcept TypeError:\n    pass"]
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    refused = [line for line, (error, *_) in zip(lines, answers, strict=True) if error]
    assert len(refused) == len(_PLACES) * len(_FLOATS)
    for line in lines:
        code = "\n".join([*made, line])
        findings = rule_checker.check(code, rules=["wrong-type"])
        assert len(findings) == (line in refused), line
        if findings and "np." in line:
            mended = apply_fixes(Source(code), findings)
            assert mended.count == 1
            assert run_statements(tmp_path, mended.text.splitlines())[-1][0] == ""


def test_a_buffer_that_has_other_uses_is_not_surely_one_of_ints(rule_checker: Checker) -> None:
    code = (
        "import bpy\nimport numpy as np\nmesh = bpy.data.meshes['Cube']\nkept = np.ones(6)\n"
        "mesh.polygons.foreach_set('use_smooth', kept)\nprint(kept / 2)\n"
    )
    (found,) = rule_checker.check(code, rules=["wrong-type"])
    assert found.fix is not None
    assert not found.fix.sure
