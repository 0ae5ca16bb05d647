"""Bakes, renders and jobs of ``simworlds mcp --attach`` with a real window, beside a user who works there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
import pytest
from attached_client import build, digests, picture, server, state, text, use
from mcp import Client
from open_window import OpenWindow, opened

from agents.blender.tools import bake, job, render
from simworlds.schemas.json_schema import schema_of

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

pytestmark = [pytest.mark.window, pytest.mark.anyio]

CLOTH = """\
# a falling cloth
import bmesh
made = bmesh.new()
bmesh.ops.create_grid(made, x_segments={size}, y_segments={size}, size=1)
mesh = bpy.data.meshes.new("Sheet")
made.to_mesh(mesh)
sheet = bpy.data.objects.new("Sheet", mesh)
bpy.context.scene.collection.objects.link(sheet)
sheet.location.z = 3
sheet.modifiers.new("Cloth", "CLOTH")
bpy.context.scene.frame_end = {frames}
"""
LIQUID = """\
# a little water
def box(name, size, place):
    bpy.ops.mesh.primitive_cube_add(size=size, location=place)
    bpy.context.object.name = name
    return bpy.context.object
tank = box("Tank", 2, (0, 0, 1))
tank.modifiers.new("Fluid", "FLUID").fluid_type = "DOMAIN"
domain = tank.modifiers[0].domain_settings
domain.domain_type = "LIQUID"
domain.resolution_max = 16
domain.use_mesh = True
drop = box("Drop", 0.8, (0, 0, 1.2))
drop.modifiers.new("Fluid", "FLUID").fluid_type = "FLOW"
drop.modifiers[0].flow_settings.flow_type = "LIQUID"
bpy.context.scene.frame_end = 4
"""
BAKED = "bpy.data.objects['Sheet'].modifiers[0].point_cache.is_baked"
ENDLESS = {"size": 30, "frames": 5000}


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenWindow]:
    yield from opened(tmp_path_factory.mktemp("window"), numpy=True)


@pytest.fixture(scope="module")
async def client(window: OpenWindow) -> AsyncIterator[Client]:
    async with Client(server(window), read_timeout_seconds=300) as connected:
        yield connected


async def value(client: Client, code: str) -> Any:
    """What an expression is in the open Blender."""
    result = await use(client, "blender_execute", code=code)
    assert not result.is_error, text(result)
    assert result.structured_content is not None
    return result.structured_content["value"]


async def make(client: Client, code: str) -> None:
    result = await use(client, "blender_execute", code=code, timeout=120)
    assert not result.is_error, text(result)


async def until_it_is_past(client: Client, frame: int) -> None:
    """Waits until the newest job has baked so many frames; polls may miss any single one of them."""
    with anyio.fail_after(120):
        while True:
            told = await use(client, "blender_job", action="status")
            assert told.structured_content is not None
            assert told.structured_content["state"] in {"waiting", "running"}, text(told)
            match = re.search(r"frame (\d+) of 1–5000", text(told))
            if match is not None and int(match[1]) >= frame:
                return
            await anyio.sleep(0.2)


async def test_long_work_has_the_schemas_of_any_other_session(client: Client) -> None:
    listed = {tool.name: tool for tool in (await client.list_tools()).tools}
    for tool in (bake.TOOL, render.TOOL, job.TOOL):
        properties = listed[tool.name].input_schema["properties"]
        assert properties.keys() == schema_of(tool.arguments)["properties"].keys()


async def test_a_bake_is_one_step_that_can_be_undone(client: Client) -> None:
    await make(client, CLOTH.format(size=8, frames=12))
    before = await digests(client)
    at = await state(client)
    baked = await use(client, "blender_bake")
    assert not baked.is_error, text(baked)
    assert "Baked 1 of 1 caches over frames 1–12" in text(baked)
    assert "moves up to 0." in text(baked)
    assert await value(client, BAKED) == "True"
    assert (await state(client))["frame"] == at["frame"]
    shown = await use(client, "blender_scene_layout_preview", frame=12)
    assert not shown.is_error, text(shown)
    undone = await use(client, "blender_undo")
    assert "SimWorlds: bake" in text(undone)
    assert "as it was before" in text(undone)
    assert await value(client, BAKED) == "False"
    assert await digests(client) == before
    await use(client, "blender_undo")


async def test_a_job_tells_how_far_it_is_refuses_other_calls_and_undoes_itself(client: Client) -> None:
    await make(client, CLOTH.format(**ENDLESS))
    before = await digests(client)
    started = await use(client, "blender_job", action="start", tool="blender_bake")
    assert "Started job 1 (blender_bake)" in text(started)
    await until_it_is_past(client, 3)
    refused = await use(client, "blender_scene_state")
    assert refused.is_error
    assert "blender_scene_state was not done: job 1 (blender_bake) has run for" in text(refused)
    cancelled = await use(client, "blender_job", action="cancel")
    assert "was cancelled after" in text(cancelled)
    assert "what it had done in the open Blender was undone" in text(cancelled)
    assert await value(client, BAKED) == "False"
    assert await digests(client) == before
    await use(client, "blender_undo")


async def test_the_user_ends_a_bake_with_esc_and_cannot_disturb_it(
    client: Client, window: OpenWindow
) -> None:
    await make(client, CLOTH.format(**ENDLESS))
    before = await digests(client)
    await use(client, "blender_job", action="start", tool="blender_bake")
    await until_it_is_past(client, 3)
    window.act("mousemove", "500", "380", "key", "a", "key", "Delete")  # would remove everything
    await until_it_is_past(client, 6)
    window.act("key", "Escape")
    ended = await use(client, "blender_job", action="result", wait=60)
    assert ended.is_error
    assert "The user has ended the bake with Esc" in text(ended)
    assert await digests(client) == before
    await use(client, "blender_undo")


async def test_a_bake_that_takes_too_long_is_undone(client: Client) -> None:
    await make(client, CLOTH.format(**ENDLESS))
    late = await use(client, "blender_bake", timeout=8)
    assert late.is_error
    assert "was not done in 8 s" in text(late)
    assert await value(client, BAKED) == "False"
    await use(client, "blender_undo")


async def test_a_fluid_is_baked_in_the_copy_and_shown_in_the_window(
    client: Client, window: OpenWindow
) -> None:
    await make(client, LIQUID)
    before = await digests(client)
    baked = await use(client, "blender_bake", timeout=200)
    assert not baked.is_error, text(baked)
    assert "liquid of 'Tank': frames 1–4" in text(baked)
    told = await value(client, "bpy.data.objects['Tank'].modifiers[0].domain_settings.cache_directory")
    folder = Path(told.strip("'"))
    assert str(folder) in text(baked)
    assert folder.is_relative_to(window.home / "runs")
    assert list(folder.rglob("*.vdb"))
    saved = await use(client, "blender_save", name="wet")
    assert not saved.is_error, text(saved)
    assert list((window.home / "runs").glob("*/blendcache_wet/**/*.vdb"))  # the copy has the frames, too
    freed = await use(client, "blender_bake", free=True)
    assert "liquid of 'Tank'" in text(freed)
    undone = await use(client, "blender_undo", steps=2)
    assert "as it was before" in text(undone), text(undone)
    assert await digests(client) == before
    await use(client, "blender_undo")


async def test_renders_the_copy_while_the_window_stays_as_it_is(client: Client) -> None:
    await build(client, "Rendered", 2)
    before = await state(client)
    still = await use(
        client, "blender_render", engine="cycles", samples=1, denoise=False, width=64, height=48
    )
    assert not still.is_error, text(still)
    assert picture(still).size == (64, 48)
    arguments = {
        "kind": "animation",
        "engine": "cycles",
        "samples": 1,
        "denoise": False,
        "width": 64,
        "height": 48,
    }
    arguments |= {"frame_start": 1, "frame_end": 2}
    await use(client, "blender_job", action="start", tool="blender_render", arguments=arguments)
    done = await use(client, "blender_job", action="result", wait=200)
    assert not done.is_error, text(done)
    assert "2 frames rendered" in text(done)
    assert await state(client) == before
    await use(client, "blender_undo")
