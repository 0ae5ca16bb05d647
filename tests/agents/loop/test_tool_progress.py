"""The loop hears how far a tool has got, so that whoever watches a run sees a long bake go on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from agents.blender.blender_sessions import SessionSetup
from agents.loop.running.tool_client import ToolClient
from simworlds.sandbox.confinement.confined_command import best_sandbox

if TYPE_CHECKING:
    from pathlib import Path

CLOTH = """\
bpy.ops.mesh.primitive_grid_add(x_subdivisions=30, y_subdivisions=30)
bpy.ops.object.modifier_add(type='CLOTH')
bpy.context.scene.frame_end = 60
"""


@pytest.mark.blender
def test_a_bake_is_heard_frame_by_frame(tmp_path: Path) -> None:
    heard: list[tuple[str, float, float | None, str]] = []
    setup = SessionSetup(best_sandbox(), run=tmp_path / "run")
    with ToolClient(setup, progress=lambda *told: heard.append(told)) as tools:
        tools.call("blender_execute", {"code": CLOTH})
        assert not tools.call("blender_bake", {}).failed
    done = [at for tool, at, total, _ in heard if tool == "blender_bake" and total]
    assert done == sorted(set(done))
    assert len(done) >= 2
    assert "cloth of 'Grid': frame" in heard[0][3]
