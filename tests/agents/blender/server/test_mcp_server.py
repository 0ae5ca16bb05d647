"""``simworlds mcp`` over stdio, as real clients start it, with a real Blender behind it."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from ast import literal_eval
from base64 import b64decode
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
import pytest
from mcp import Client
from mcp.shared.exceptions import MCPError
from mcp_types import ImageContent, TextResourceContents
from PIL import Image
from running import run_here
from serving import COMMAND, REPO, ByHand, below, blenders, environment, have_ended, over_stdio

from agents.blender import server as served
from agents.blender.blender_sessions import BlenderSessions, SessionSetup
from agents.blender.docs_client import DocsClient
from agents.blender.tool_catalogue import TOOLS
from agents.blender.tool_profiles import DEFAULT, is_within
from agents.blender.tools import execute
from simworlds.sandbox.confinement.confined_command import best_sandbox

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mcp_types import CallToolResult

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

FOREVER = "while True: pass"
ENDS = 60.0  # seconds, within which what was told to end has ended on any machine, however busy


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def home(base: Path) -> Path:
    """Where a base of this environment's Blender is."""
    return base.parent.parent


@pytest.fixture(scope="module")
async def client(home: Path) -> AsyncIterator[Client]:
    """A client of a server that all tests share who leave it as it was."""
    async with Client(over_stdio(home)) as connected:
        yield connected


async def run(client: Client, code: str, **more: Any) -> CallToolResult:
    return await client.call_tool("blender_execute", {"code": code, **more})


async def value(client: Client, code: str) -> str:
    answer = await run(client, code)
    assert not answer.is_error, said(answer)
    assert answer.structured_content is not None
    return answer.structured_content["value"]


def said(answer: CallToolResult) -> str:
    assert answer.content[0].type == "text"
    return answer.content[0].text


# What there is


async def test_every_tool_of_the_suite_is_listed_beside_the_documentation(client: Client) -> None:
    listed = (await client.list_tools()).tools
    assert [tool.name for tool in listed] == [
        *(tool.name for tool in TOOLS if is_within(tool.profile, DEFAULT)),
        "blender_job",
        "blender_plan_check",
        "blender_docs",
        "blender_check",
    ]
    assert all(tool.description for tool in listed)


async def test_every_argument_is_described_to_the_model(client: Client) -> None:
    (whole,) = (await client.read_resource("blender://tools")).contents
    assert isinstance(whole, TextResourceContents)
    described = {entry["name"]: entry["inputSchema"]["properties"] for entry in json.loads(whole.text)}
    for tool in (await client.list_tools()).tools:
        assert tool.input_schema["type"] == "object"
        told = [field.get("description") for field in described[tool.name].values()]
        assert all(told), tool.name
        for name, field in tool.input_schema["properties"].items():
            # What an argument before it says already, as of frame_start and frame_end, is not said again.
            text = described[tool.name][name]["description"]
            assert field.get("description") == text or told.count(text) > 1, f"{tool.name}: {name}"
            assert "title" not in field
        assert "$ref" not in json.dumps(tool.input_schema)


async def test_annotations_say_what_a_call_may_do(client: Client) -> None:
    listed = {tool.name: tool for tool in (await client.list_tools()).tools}
    for tool in TOOLS:
        whole = served.entry(tool).annotations
        assert whole is not None
        assert (whole.read_only_hint, whole.destructive_hint) == (tool.read_only, tool.destructive)
        assert whole.idempotent_hint == tool.read_only
        assert whole.open_world_hint is False
        if (
            tool.name in listed
        ):  # a hint that is left out has the protocol's default: a tool may write and destroy
            hints = listed[tool.name].annotations
            assert hints is not None
            assert bool(hints.read_only_hint) == tool.read_only
            assert tool.read_only or (hints.destructive_hint is not False) == tool.destructive


async def test_instructions_name_only_existing_tools(client: Client) -> None:
    listed = {tool.name for tool in (await client.list_tools()).tools}
    assert client.instructions is not None
    named = {
        line.split(":")[0].removeprefix("- ") for line in client.instructions.splitlines() if line[:2] == "- "
    }
    assert {"blender_docs", "blender_execute"} <= named <= listed
    assert len(client.instructions) < 2048


# Of the two, the shared client speaks the newer one, and whoever speaks by hand here the older one.
@pytest.mark.whole
@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_clients_of_both_protocols_work_in_a_scene_that_stays(home: Path, mode: Any) -> None:
    async with Client(over_stdio(home), mode=mode) as connected:
        await run(connected, "bpy.ops.mesh.primitive_cube_add(size=3)")
        assert await value(connected, "tuple(bpy.context.object.dimensions)") == "(3.0, 3.0, 3.0)"


# Calls


async def test_an_answer_is_text_and_data(client: Client) -> None:
    answer = await run(client, "print('heard')\n6 * 7")
    assert "Value: `42`" in said(answer)
    assert answer.structured_content is not None
    assert (answer.structured_content["value"], answer.structured_content["stdout"]) == ("42", "heard\n")
    assert not answer.is_error


async def test_a_preview_comes_as_a_picture_beside_its_text(client: Client) -> None:
    await run(client, "bpy.ops.mesh.primitive_monkey_add()")
    answer = await client.call_tool("blender_scene_layout_preview", {})
    assert [part.type for part in answer.content] == ["text", "image"]
    picture = answer.content[1]
    assert isinstance(picture, ImageContent)
    assert picture.mime_type == "image/png"
    with Image.open(BytesIO(b64decode(picture.data))) as opened:
        assert opened.format == "PNG"
        assert min(opened.size) > 500
        assert len(opened.convert("L").getcolors() or []) > 20


async def test_failed_code_is_an_error_with_what_the_documentation_says(client: Client) -> None:
    answer = await run(client, "import mathutils\nmathutils.Vector((1, 2, 3)).lenght", preflight="off")
    assert answer.is_error
    assert "Vector.length" in said(answer)
    assert answer.structured_content is not None
    assert answer.structured_content["error"]["documentation"] in said(answer)


async def test_wrong_arguments_are_named(client: Client) -> None:
    answer = await client.call_tool("blender_execute", {"code": "1", "timeout": "soon", "colour": 1})
    assert answer.is_error
    assert "timeout" in said(answer)
    assert "colour" in said(answer)


async def test_an_unknown_tool_is_refused_with_those_that_there_are(client: Client) -> None:
    with pytest.raises(MCPError, match="blender_execute"):
        await client.call_tool("blender_explode", {})


async def test_reports_a_crash_with_its_output_and_restarts(client: Client) -> None:
    answer = await run(client, "import os\nprint('last words')\nos._exit(7)")
    assert answer.is_error
    assert "exit code 7" in said(answer)
    assert "last words" in said(answer)
    assert "checkpoint" in said(answer)
    assert await value(client, "1 + 1") == "2"


async def test_calls_that_come_at_once_are_run_one_after_the_other(client: Client) -> None:
    found: list[int] = []

    async def count() -> None:
        code = (
            "import time\ns = bpy.context.scene\nn = s.get('n', 0)\ntime.sleep(0.01)\ns['n'] = n + 1\nn + 1"
        )
        found.append(int(await value(client, code)))

    await run(client, "bpy.context.scene['n'] = 0")
    async with anyio.create_task_group() as calls:
        for _ in range(10):
            calls.start_soon(count)
    assert sorted(found) == list(range(1, 11))


async def test_a_call_that_is_cancelled_is_undone_and_the_next_one_works(client: Client) -> None:
    await run(client, "bpy.context.scene['kept'] = 1")
    with anyio.move_on_after(1.0) as waited:
        await run(client, f"bpy.context.scene['kept'] = 2\n{FOREVER}", timeout=100)
    assert waited.cancelled_caught
    after = (await run(client, "bpy.context.scene['kept']")).structured_content
    assert after is not None
    assert after["value"] == "1"
    assert "was cancelled after" in after["note"]
    assert "started from checkpoint" in after["note"]


async def test_cancelling_a_waiting_call_affects_no_other_call(
    client: Client,
) -> None:
    await run(client, "bpy.context.scene['ran'] = ''")

    async def add(letter: str, patience: float, seconds: float = 0) -> None:
        with anyio.move_on_after(patience):
            await run(client, f"bpy.context.scene['ran'] += {letter!r}\nimport time; time.sleep({seconds})")

    async with anyio.create_task_group() as calls:
        for call in (("a", 60, 1.5), ("b", 0.2), ("c", 60)):
            calls.start_soon(add, *call)
            await anyio.wait_all_tasks_blocked()
    assert await value(client, "bpy.context.scene['ran']") == "'ac'"


async def test_the_documentation_answers_while_blender_works(client: Client) -> None:
    async with anyio.create_task_group() as calls:
        calls.start_soon(run, client, "import time; time.sleep(50)")
        await anyio.wait_all_tasks_blocked()
        with anyio.fail_after(30):
            answer = await client.call_tool("blender_docs", {"query": "ClothSettings.quality"})
        calls.cancel_scope.cancel()
    assert answer.structured_content is not None
    assert answer.structured_content["hits"][0]["id"] == "bpy.types.ClothSettings.quality"


async def test_resources_of_the_documentation_are_passed_on(client: Client) -> None:
    assert "blender://bases" in [str(one.uri) for one in (await client.list_resources()).resources]
    assert (await client.list_resource_templates()).resource_templates
    page = await client.read_resource("blender://5.1/symbol/bpy.types.ClothSettings.quality")
    assert "quality" in page.contents[0].text  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(MCPError, match="no such resource"):
        await client.read_resource("blender://5.1/nothing")


async def test_progress_is_reported_at_a_limited_rate(
    client: Client,
) -> None:
    await run(
        client,
        "bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20)\n"
        "bpy.ops.object.modifier_add(type='CLOTH')\nbpy.context.scene.frame_end = 40",
    )
    heard: list[float] = []

    async def hear(done: float, total: float | None, message: str | None) -> None:
        del total, message
        heard.append(done)

    began = time.monotonic()
    answer = await client.call_tool("blender_bake", {}, progress_callback=hear)
    seconds = time.monotonic() - began
    assert not answer.is_error, said(answer)
    assert heard == sorted(set(heard))
    assert 1 <= len(heard) <= seconds / 0.25 + 2


# What goes wrong on our side


@pytest.mark.usefixtures("shared_docs")
async def test_an_unforeseen_error_shows_no_traceback(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(*_: object) -> Any:
        return {}["a secret of ours"]

    suite = served.Suite((replace(execute.TOOL, run=broken),))
    blender_sessions = BlenderSessions(SessionSetup(best_sandbox(), run=tmp_path / "run"))
    async with Client(served.make_server(blender_sessions, DocsClient(), suite=suite)) as connected:
        answer = await run(connected, "1")
    assert answer.is_error
    assert "KeyError" in said(answer)
    assert "secret" not in said(answer)
    assert "Traceback" not in said(answer)
    assert "a secret of ours" in caplog.text


def test_without_a_base_blender_works_and_one_is_built_meanwhile(tmp_path: Path) -> None:
    with ByHand(tmp_path) as wire:
        code = {"code": "bpy.context.scene.name"}
        first, second = (
            wire.call("tools/call", name="blender_execute", arguments=code)["result"] for _ in range(2)
        )
        assert first["structuredContent"]["value"] == "'Scene'"
        assert "not checked before it runs: " in first["content"][0]["text"]
        assert "There is no knowledge base" in first["content"][0]["text"]
        assert "not checked" not in second["content"][0]["text"]
        failed = wire.call("tools/call", name="blender_execute", arguments={"code": "bpy.types.Nonsense"})
        assert failed["result"]["structuredContent"]["error"]["documentation"] == ""
        asked = wire.call("tools/call", name="blender_docs", arguments={"query": "cloth"})["result"]
        assert asked["isError"]
        assert "There is no knowledge base" in asked["content"][0]["text"]
        assert "built in the background: try again" in asked["content"][0]["text"]


# Beginning and end


def test_a_run_goes_on_in_the_next_server_which_describes_its_sandbox_truthfully(
    home: Path, tmp_path: Path
) -> None:
    for name in ("assets", "private"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "note.txt").write_text(name)
    folder = str(tmp_path / "run")
    with ByHand(home, "--run", folder) as wire:
        wire.run("bpy.ops.mesh.primitive_torus_add()\nbpy.context.object.name = 'Ring'")
        refused = subprocess.run(
            [*COMMAND, "--run", folder],
            env=environment(home),
            cwd=REPO,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=True,
            timeout=ENDS,
        )
        assert "in use by another" in refused.stderr
        wire.process.send_signal(signal.SIGINT)
        assert wire.process.wait(ENDS) == 0
    with ByHand(home, "--run", folder, "--read", str(tmp_path / "assets")) as wire:
        assert wire.run("[thing.name for thing in bpy.data.objects]") == "['Ring']"
        assert wire.run(f"open({str(tmp_path / 'assets' / 'note.txt')!r}).read()") == "'assets'"
        code = f"open({str(tmp_path / 'private' / 'note.txt')!r}).read()"
        assert wire.call("tools/call", name="blender_execute", arguments={"code": code})["result"]["isError"]
        wire.process.send_signal(signal.SIGTERM)
        told = wire.said()
    assert "Sandbox (" in told
    assert f"works in {folder}" in told


def test_a_documentation_server_that_was_killed_is_started_again_and_stdout_has_only_messages(
    home: Path,
) -> None:
    with ByHand(home) as wire:
        ask = {"name": "blender_docs", "arguments": {"query": "ClothSettings.quality"}}
        assert not wire.call("tools/call", **ask)["result"]["isError"]
        servers = [pid for pid, words in below(wire.process.pid).items() if words.rstrip().endswith("serve")]
        assert len(servers) == 1
        subprocess.run(["kill", "-KILL", str(servers[0])], check=True)
        assert have_ended(servers)
        assert not wire.call("tools/call", **ask)["result"]["isError"]
        for _ in range(5):
            assert (
                wire.run("import os; print('noise'); os.write(1, b'more'); os.write(2, b'and more'); 3")
                == "3"
            )
        place = Path(literal_eval(wire.run("import os; os.getcwd()")))
        started = below(wire.process.pid)
        assert blenders(wire.process.pid)
        assert wire.hang_up() == b""
        assert wire.process.wait(ENDS) == 0
        assert have_ended(started)
    assert place.is_dir(), "the run is kept"


def test_unused_run_leaves_no_folder(home: Path, tmp_path: Path) -> None:
    (tmp_path / "kb").symlink_to(home / "kb")  # else one would be built
    with ByHand(tmp_path) as wire:
        wire.hang_up()
        assert wire.process.wait(ENDS) == 0
    assert list((tmp_path / "runs").glob("*")) == []


def test_a_client_that_goes_away_while_blender_is_busy_leaves_no_process_behind(home: Path) -> None:
    with ByHand(home) as wire:
        wire.begin(FOREVER)
        started = below(wire.process.pid)
        assert blenders(wire.process.pid)
        wire.hang_up()
        assert wire.process.wait(ENDS) == 0
        assert have_ended(started)


@pytest.mark.parametrize("number", [pytest.param(signal.SIGTERM, marks=pytest.mark.whole), signal.SIGKILL])
def test_a_signal_leaves_no_process_behind_though_blender_is_busy(home: Path, number: signal.Signals) -> None:
    with ByHand(home) as wire:
        wire.begin(FOREVER)
        started = below(wire.process.pid)
        assert blenders(wire.process.pid)
        wire.process.send_signal(number)
        assert wire.process.wait(ENDS) == (-number if number == signal.SIGKILL else 0)
        assert have_ended(started)


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (["--blender-exe", "/nowhere/blender"], "/nowhere/blender"),
        (["--sessions", "3"], "--sessions needs --http"),
        (["--token", "secret"], "--token needs --http"),
        (["--tools", "docs", "--blender", "five"], "'five' is not a Blender version"),
        (["--read", "/nowhere"], "/nowhere"),
        (["--http", "--host", "0.0.0.0"], "SIMWORLDS_TOKEN"),
    ],
)
def test_reports_startup_errors_at_once(tmp_path: Path, options: list[str], why: str) -> None:
    done = run_here(["mcp", *options], environment(tmp_path), REPO)
    assert done.returncode == 2
    assert why in done.stderr.decode()
    assert done.stdout == b""
