"""Renders that write no file: told where Blender writes none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_SET = """\
import bpy
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.render.resolution_x = scene.render.resolution_y = 8
"""


def test_a_file_is_written_only_where_that_is_said(check: Check, tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    code = f"{_SET}scene.render.filepath = {str(picture)!r}\nbpy.ops.render.render()\n"
    found = check("unsaved-render", code)
    assert [one.span.line for one in found] == [7]
    assert not run_statements(tmp_path, [code])[0][0]
    assert not picture.exists()
    mended = apply_fixes(Source(code), found, unsafe=True).text
    assert not run_statements(tmp_path, [mended])[0][0]
    assert picture.stat().st_size
    assert not check("unsaved-render", mended)


@pytest.mark.parametrize(
    "code",
    [
        "bpy.ops.render.render()",
        "scene.render.filepath = '/tmp/a'\nbpy.ops.render.render(animation=True)",
        "scene.render.filepath = '/tmp/a'\nbpy.ops.render.render('INVOKE_DEFAULT')",
        "scene.render.filepath = '/tmp/a'\nbpy.ops.render.render(**options)",
        "scene.render.filepath = '/tmp/a'\nbpy.ops.render.render()\n"
        "bpy.data.images['Render Result'].save_render('/tmp/a.png')",
    ],
)
def test_what_writes_otherwise_is_left_alone(check: Check, code: str) -> None:
    assert not check("unsaved-render", f"import bpy\nscene = bpy.context.scene\n{code}\n")
