"""What Blender does not let be assigned, though RNA calls it writable, is reported; what a switch frees is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MESH = "import bpy\nmesh = bpy.data.meshes.new('a')\n"
_LAYER = "import bpy\nlayer = bpy.data.grease_pencils.new('a').layers.new('a')\n"
_SCRIPTS = {
    f"{_MESH}mesh.texspace_size = (1, 1, 1)": "warning",
    f"{_LAYER}layer.channel_color = (1, 0, 0)": "error",
    f"{_MESH}mesh.use_auto_texspace = False\nmesh.texspace_size = (1, 1, 1)": "",
    f"{_MESH}mesh.use_auto_texspace = True": "",
    f"{_LAYER}layer.tint_color = (1, 0, 0)": "",
}


@pytest.mark.blender
@pytest.mark.parametrize("script", _SCRIPTS)
def test_what_is_locked_is_found_as_blender_refuses_it(script: str, check: Check, tmp_path: Path) -> None:
    *_, (failed, *_) = run_statements(tmp_path, script.splitlines())
    assert bool(failed) is bool(_SCRIPTS[script])
    found = check("read-only", script)
    assert [finding.severity for finding in found] == [_SCRIPTS[script]] * bool(_SCRIPTS[script])
    assert all(finding.span.line == len(script.splitlines()) for finding in found)
