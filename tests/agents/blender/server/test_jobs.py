"""``blender_job`` as clients of ``simworlds mcp`` use it: long work that goes on while nobody waits."""

from __future__ import annotations

import signal
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any

import anyio
import pytest
from live_session import LiveSession
from mcp import Client
from mcp_types import ImageContent
from serving import ByHand, OverHttp, blenders, have_ended, over_stdio

from agents.blender.blender_sessions import BlenderSessions, SessionSetup
from agents.blender.docs_client import DocsClient
from agents.blender.jobs import SessionJobs
from agents.blender.server import make_server
from agents.blender.tools.base import Call, Result, parse
from agents.blender.tools.job import TOOL, WORK, JobArguments
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from mcp_types import CallToolResult

    from agents.blender.tools.base import BlenderTool

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

EMPTY = "bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)\n"
CLOTH = (
    EMPTY
    + "bpy.ops.mesh.primitive_grid_add(x_subdivisions={size}, y_subdivisions={size}, location=(0, 0, 1))\n"
    + "bpy.context.object.name = 'Sheet'\n"
    + "bpy.ops.object.modifier_add(type='CLOTH')\n"
    + "bpy.context.scene.frame_end = {frames}\n"
    + "bpy.context.object.modifiers[0].point_cache.frame_end = {frames}\n"
    + "bpy.context.scene['stands'] = 1"
)
BAKED = "bpy.data.objects['Sheet'].modifiers[0].point_cache.is_baked"
ENDLESS = {"size": 100, "frames": 100_000}
SHORT = {"size": 10, "frames": 8}
LONG_ENOUGH = 200.0  # seconds in which a short job ends on any machine


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
async def client(base: Path) -> AsyncIterator[Client]:
    async with Client(over_stdio(base.parent.parent)) as connected:
        yield connected


async def do(client: Client, **arguments: Any) -> CallToolResult:
    return await client.call_tool("blender_job", arguments)


async def run(client: Client, code: str) -> Any:
    answer = await client.call_tool("blender_execute", {"code": code, "preflight": "off"})
    assert not answer.is_error, said(answer)
    return data(answer)["value"]


def said(answer: CallToolResult) -> str:
    assert answer.content[0].type == "text"
    return answer.content[0].text


def data(answer: CallToolResult) -> dict[str, Any]:
    assert answer.structured_content is not None
    return answer.structured_content


async def start(client: Client, tool: str, **arguments: Any) -> int:
    answer = await do(client, action="start", tool=tool, arguments=arguments)
    assert not answer.is_error, said(answer)
    return data(answer)["job"]


async def until_it_runs(client: Client) -> None:
    """Waits until the last job has reported something."""
    while data(await do(client, action="status", wait=0.2))["progress"] is None:
        pass


async def test_a_job_gives_the_result_of_its_tool(client: Client) -> None:
    await run(client, CLOTH.format(**SHORT))
    number = await start(client, "blender_bake")
    answer = await do(client, action="result", wait=LONG_ENOUGH)
    assert not answer.is_error
    assert said(answer).startswith(f"Job {number} (blender_bake) ended after ")
    assert "Baked 1 of 1 caches over frames 1–8" in said(answer)
    assert data(answer)["state"] == "done"
    assert data(answer)["result"]["range"] == [1, 8]
    assert await run(client, BAKED) == "True"


async def test_a_result_is_kept_until_it_is_fetched_and_longer(client: Client) -> None:
    await run(client, CLOTH.format(**SHORT))
    first = await start(client, "blender_trial", frames=3)
    await do(client, action="status", wait=LONG_ENOUGH)
    second = await start(client, "blender_bake")
    ended = await do(client, action="status", wait=LONG_ENOUGH)
    assert said(ended).endswith(f"Results not fetched yet: of job {first}.")
    for _ in range(2):
        answer = await do(client, action="result", job=first)
        assert "a trial bakes nothing" in said(answer)
        assert any(isinstance(part, ImageContent) for part in answer.content)
    assert data(await do(client, action="result"))["job"] == second


async def test_progress_is_reported_while_the_client_waits(client: Client) -> None:
    await run(client, CLOTH.format(size=60, frames=30))
    await start(client, "blender_bake")
    heard: list[tuple[float, float | None, str | None]] = []

    async def hear(done: float, total: float | None, message: str | None) -> None:
        heard.append((done, total, message))

    await client.call_tool("blender_job", {"action": "result", "wait": LONG_ENOUGH}, progress_callback=hear)
    assert heard
    assert [done for done, *_ in heard] == sorted({done for done, *_ in heard})
    assert all(total and "frame" in str(message) for _, total, message in heard)


async def test_other_calls_say_at_once_what_runs_and_a_cancel_undoes_the_job_alone(client: Client) -> None:
    await run(client, CLOTH.format(**ENDLESS))
    number = await start(client, "blender_bake")
    await until_it_runs(client)
    for tool, arguments in (
        ("blender_execute", {"code": "1"}),
        ("blender_scene_state", {}),
        ("blender_job", {"action": "start", "tool": "blender_trial"}),
    ):
        with anyio.fail_after(20):
            refused = await client.call_tool(tool, arguments)
        assert refused.is_error
        assert f"job {number} (blender_bake) has run for" in said(refused)
        assert "action='cancel'" in said(refused)
    docs = await client.call_tool("blender_docs", {"query": "bpy.types.ClothSettings.quality"})
    assert not docs.is_error
    running = await do(client, action="result", wait=0.5)
    assert not running.is_error
    assert data(running)["state"] == "running"
    ended = await do(client, action="cancel")
    assert not ended.is_error
    assert data(ended)["state"] == "cancelled"
    assert "the scene as it was before" in said(ended)
    assert await run(client, f"bpy.context.scene['stands'], {BAKED}") == "(1, False)"
    assert "Nothing to cancel" in said(await do(client, action="cancel"))


async def test_a_cancelled_animation_keeps_its_frames_and_goes_on_from_them(client: Client) -> None:
    await run(
        client,
        f"{EMPTY}bpy.ops.mesh.primitive_cube_add()\nbpy.ops.object.camera_add(location=(0, -8, 0), "
        "rotation=(1.57, 0, 0))\nbpy.context.scene.camera = bpy.context.object",
    )
    film: dict[str, Any] = {
        "kind": "animation",
        "engine": "workbench",
        "width": 64,
        "height": 48,
        "video": False,
    }
    await start(client, "blender_render", **film, frame_end=5000)
    await until_it_runs(client)
    ended = data(await do(client, action="cancel"))
    assert ended["state"] == "cancelled"
    made = ended["result"]["made"]
    assert made >= 1
    await start(client, "blender_render", **film, frame_end=made)
    assert data(await do(client, action="result", wait=LONG_ENOUGH))["result"]["kept"] == made


async def test_what_a_job_cannot_do_is_told_at_once(client: Client) -> None:
    for arguments, word in (
        ({"action": "start"}, "start needs tool"),
        ({"action": "start", "tool": "blender_execute"}, "blender_bake"),
        ({"action": "start", "tool": "blender_bake", "arguments": {"frames": 3}}, "frames"),
        ({"action": "status", "tool": "blender_bake"}, "belong to action='start'"),
        ({"action": "result", "job": 9999}, "no job 9999"),
    ):
        answer = await do(client, **arguments)
        assert answer.is_error
        assert word in said(answer)


async def test_a_job_that_fails_says_why(client: Client) -> None:
    await run(client, EMPTY)
    await start(client, "blender_bake")
    answer = await do(client, action="result", wait=LONG_ENOUGH)
    assert answer.is_error
    assert data(answer)["state"] == "failed"
    assert "no simulation" in said(answer).lower() or "nothing to bake" in said(answer).lower()


async def test_a_client_that_stops_waiting_ends_its_call_and_not_the_job(client: Client) -> None:
    await run(client, CLOTH.format(**ENDLESS))
    await start(client, "blender_bake")
    await until_it_runs(client)
    with anyio.move_on_after(0.5):
        await do(client, action="status", wait=LONG_ENOUGH)
    assert data(await do(client, action="status"))["state"] == "running"
    await do(client, action="cancel")


def test_a_client_that_leaves_takes_the_job_with_it_and_finds_the_scene(base: Path, tmp_path: Path) -> None:
    home, folder = base.parent.parent, str(tmp_path / "run")
    with ByHand(home, "--run", folder) as server:
        server.run(CLOTH.format(**ENDLESS))
        asked = {"action": "start", "tool": "blender_bake"}
        server.call("tools/call", name="blender_job", arguments=asked)
        while True:
            status = server.call(
                "tools/call", name="blender_job", arguments={"action": "status", "wait": 0.2}
            )
            if status["result"]["structuredContent"]["progress"]:
                break
        started = blenders(server.process.pid)
        server.hang_up()
        server.process.wait(60)
    assert have_ended(started)
    session = LiveSession(tmp_path / "run")
    with session.blender:
        assert session.run(f"bpy.context.scene['stands'], {BAKED}") == (1, False)


async def test_over_http_a_job_ends_with_its_session(base: Path) -> None:
    with OverHttp(base.parent.parent) as server:
        async with Client(server.url, mode="legacy") as client:
            await run(client, CLOTH.format(**ENDLESS))
            await start(client, "blender_bake")
            await until_it_runs(client)
            started = blenders(server.process.pid)
        assert have_ended(started)
        code, out, err = server.end(signal.SIGTERM)
    assert (code, out) == (0, "")
    assert "Traceback" not in err


@pytest.mark.usefixtures("shared_docs")
async def test_the_agent_loop_is_not_offered_jobs() -> None:
    sessions = BlenderSessions(SessionSetup(sandbox=best_sandbox()))
    async with Client(make_server(sessions, DocsClient())) as client:
        assert "blender_job" not in [tool.name for tool in (await client.list_tools()).tools]
        assert "blender_job" not in (client.instructions or "")


# Many jobs, without a Blender


class _Ends:
    """Stands for a session's thread: every call ends at once."""

    def __call__(self, tool: BlenderTool, arguments: dict[str, Any] | None, call: Call) -> Any:
        del tool, arguments, call
        future: Future[Result] = Future()
        future.set_result(Result("done"))
        return future


async def test_results_that_nobody_fetches_are_bounded_and_never_dropped() -> None:
    jobs = SessionJobs()

    async def use(**arguments: Any) -> Result:
        asked = parse(TOOL, arguments)
        assert isinstance(asked, JobArguments)
        return await jobs.use(asked, Call(), _Ends())

    for _ in range(16):
        await use(action="start", tool="blender_trial")
    with pytest.raises(Refusal, match="of the jobs 1, 2"):
        await use(action="start", tool="blender_trial")
    for number in range(1, 17):
        assert (await use(action="result", job=number)).text.endswith("done")
    for _ in range(16):
        await use(action="start", tool="blender_trial")
    assert (await use(action="result", job=17)).data["job"] == 17
    with pytest.raises(Refusal, match="no job 1 "):
        await use(action="result", job=1)


def test_the_schema_names_the_tools_that_can_be_jobs() -> None:
    choice = JobArguments.model_json_schema()["properties"]["tool"]["anyOf"][0]
    assert choice["enum"] == list(WORK)
