"""What scenes render with that were made from a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from live_session import LiveSession

from agents.blender.tools.files import LOAD
from agents.loop.film.planned_settings import code_of
from agents.plan.scene import RenderSettings

if TYPE_CHECKING:
    from pathlib import Path

    from run_sessions import Played

pytestmark = pytest.mark.blender

_SIZE = "render = bpy.context.scene.render\nrender.resolution_x, render.resolution_y, render.resolution_percentage"


_ENGINES = {
    "CYCLES": "scene.cycles.samples",
    "BLENDER_EEVEE": "scene.eevee.taa_render_samples",
    "BLENDER_WORKBENCH": "7",
}


def test_a_scene_takes_engine_size_and_samples_of_its_plan(tmp_path: Path) -> None:
    session = LiveSession(tmp_path)
    with session.blender:
        for engine, samples in _ENGINES.items():
            session.run("bpy.context.scene.render.resolution_percentage = 25")
            plan = {"kind": "still", "engine": engine, "resolution": [90, 60]}
            session.run(code_of(RenderSettings.model_validate(plan), 7))
            assert session.run(f"scene = bpy.context.scene\nscene.render.engine, {samples}") == (engine, 7)
            assert session.run(_SIZE) == (90, 60, 100)


def test_a_run_delivers_its_scene_with_them(mended: Played, tmp_path: Path) -> None:
    session = LiveSession(tmp_path, read=(mended.root,))
    with session.blender:
        session.use(LOAD, path=str(mended.root / "scene.blend"))
        assert session.run(_SIZE) == (64, 36, 100), "the coder has left 50 per cent"
        assert session.run("bpy.context.scene.render.filepath") == "//renders/"
    assert not (mended.root / "blender" / "delivered").exists()
