"""``simworlds mcp --attach`` with a real window: a client builds, looks and undoes beside a user who works there."""

from __future__ import annotations

import json
import os
import stat
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from attached_client import (
    BUILD,
    build,
    build_and_undo,
    digests,
    never_arrives,
    picture,
    server,
    state,
    text,
    use,
)  # fmt: skip
from mcp import Client
from open_window import OpenWindow, opened
from processes import becomes
from whole import IS_WHOLE

from agents.blender.attached.attached_blender import AttachedBlender
from agents.blender.attached.open_blenders import About, open_blenders
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Iterator
    from pathlib import Path

pytestmark = [pytest.mark.window, pytest.mark.anyio]

STATE = {"detail": "normal", "objects": None, "sections": ["collections", "objects", "view"]}

BREAK_PYTHON = """\
# what careless code does
import builtins, gc, os, sys, warnings
sys.path.clear()
sys.path_hooks.clear()
sys.path_importer_cache.clear()
try:
    import chunk  # every folder is now remembered as one without modules
except ImportError:
    pass
for name in [name for name in sys.modules if name.split(".")[0] in ("json", "numpy")]:
    del sys.modules[name]
sys.meta_path.clear()
builtins.sorted = None
builtins.added = 1
os.path.join = os.getcwd = None
os.environ["PATH"] = "/nowhere"
warnings.simplefilter("error")
sys.setrecursionlimit(300)
sys.settrace(lambda *_: None)
gc.disable()
"""
LOOK_AT_PYTHON = """\
import builtins, gc, os, sys, warnings
kept = [sys.path, sys.meta_path, sys.path_hooks, sorted(sys.path_importer_cache), warnings.filters, sys.stdout]
kept += [sorted, hasattr(builtins, "added"), os.path.join, os.getcwd, os.environ["PATH"], gc.isenabled()]
kept += [sys.getrecursionlimit(), sys.gettrace(), "json" in sys.modules]
open({!r}, "w").write(repr(kept))
"""


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenWindow]:
    """The window that all tests share."""
    yield from opened(tmp_path_factory.mktemp("window"))


@pytest.fixture(scope="module")
async def client(window: OpenWindow) -> AsyncIterator[Client]:
    """The client that most tests share; they undo what they do."""
    async with Client(server(window), read_timeout_seconds=200) as connected:
        yield connected


@pytest.fixture
def direct(window: OpenWindow, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], AttachedBlender]]:
    """Makes connections without a server in between."""
    monkeypatch.setenv("SIMWORLDS_HOME", str(window.home))
    made: list[AttachedBlender] = []

    def connect() -> AttachedBlender:
        made.append(AttachedBlender("open", "a test", copy_in(window.root), lambda _line: None))
        return made[-1]

    yield connect
    for blender in made:
        blender.close()


def copy_in(folder: Path) -> Callable[[About], str]:
    return lambda about: str(folder / f"copy-{about.process}.blend")


async def test_only_its_user_can_read_where_it_listens(window: OpenWindow) -> None:
    file = window.home / "open-blenders" / f"{window.process.pid}.json"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert stat.S_IMODE(file.parent.stat().st_mode) == 0o700
    assert json.loads(file.read_text())["process"] == window.process.pid


def test_looking_changes_nothing_that_the_user_has_set(
    window: OpenWindow, direct: Callable[[], AttachedBlender]
) -> None:
    """Rendered looks write a copy, and draw in another Blender."""
    blender = direct()
    blender.call("scene_state", STATE, dict, timeout=60)  # Blender evaluates the scene once
    before = blender.call("user_digests", {}, dict, timeout=60).value
    path = str(window.root / "look.png")
    for tool, arguments in (
        ("write_copy", {"path": str(window.root / "look.blend"), "seconds": 5}),
        ("screenshot", {"path": path, "editor": "VIEW_3D"}),
        ("screenshot", {"path": path, "editor": None}),
        ("user_state", {}),
        ("scene_state", STATE),
        ("present", {"paths": ["bpy.ops.mesh.primitive_cube_add"]}),
    ):
        blender.call(tool, arguments, unread, timeout=60)
    assert blender.call("user_digests", {}, dict, timeout=60).value == before


def test_answers_hundreds_of_calls(direct: Callable[[], AttachedBlender]) -> None:
    blender = direct()
    calls = 500 if IS_WHOLE else 200
    frames = {blender.call("user_state", {}, dict, timeout=60).value["frame"] for _ in range(calls)}
    assert frames == {1}


def test_a_client_that_disappears_in_mid_call_leaves_one_step(
    direct: Callable[[], AttachedBlender], tmp_path: Path
) -> None:
    blender = direct()
    pipe = tmp_path / "pipe"  # its two ends wait for each other
    os.mkfifo(pipe)
    code = f"bpy.data.objects['Cube'].location.x = 3\nopen({str(pipe)!r}).read()"
    arguments = {"code": code, "seconds": 30, "rehearsed": True, "step": "left alone"}
    blender.call("user_state", {}, unread, timeout=60)  # Blender is there, and has drawn its window
    blender._connected().send({"ticket": "t", "tool": "apply", "arguments": arguments, "seconds": 30})
    with pipe.open("w"):  # once the code has begun
        blender.close()
    other = direct()
    undone = other.call("undo", {"count": 1}, dict, timeout=60).value
    assert undone == {"undone": ["SimWorlds: left alone"], "matches": True, "left": 0}


def test_a_wrong_token_gets_no_answer(direct: Callable[[], AttachedBlender]) -> None:
    blender = open_blenders()[0]
    with pytest.raises(Refusal, match="does not answer"):
        direct()._met(replace(blender, token="0" * 64))


@pytest.mark.parametrize(
    "change", ["bpy.data.objects['Cube'].location.y = 4", pytest.param("pass", marks=pytest.mark.whole)]
)
def test_code_that_fails_is_undone_if_wanted(direct: Callable[[], AttachedBlender], change: str) -> None:
    blender = direct()
    first = {
        "code": "bpy.data.objects['Cube'].location.z = 4",
        "seconds": 30,
        "rehearsed": True,
        "step": "kept",
    }
    blender.call("apply", first, unread, timeout=30)
    second = {"code": f"{change}\n1/0", "seconds": 30, "rehearsed": True, "step": "undone", "restores": True}
    failed = blender.call("apply", second, dict, timeout=30).value
    assert failed["error"]["type"] == "ZeroDivisionError"
    undone = blender.call("undo", {"count": 1}, dict, timeout=60).value
    assert undone == {"undone": ["SimWorlds: kept"], "matches": True, "left": 0}


def test_code_that_runs_on_is_ended_at_its_deadline(direct: Callable[[], AttachedBlender]) -> None:
    arguments = {"code": "while True: pass", "seconds": 0.5, "rehearsed": True}
    ended = direct().call("apply", arguments, dict, timeout=30).value
    assert ended["error"]["type"] == "OutOfTime"


async def test_tools_of_an_open_blender_are_listed_with_the_shared_ones(client: Client) -> None:
    names = {tool.name for tool in (await client.list_tools()).tools}
    assert {"blender_view", "blender_show", "blender_undo", "blender_docs", "blender_check"} <= names
    assert {"blender_scene_state", "blender_execute", "blender_group", "blender_verify"} <= names
    assert not {"blender_load", "blender_import"} & names


async def test_builds_step_by_step_and_undoes_all(client: Client, window: OpenWindow) -> None:
    undone = await build_and_undo(client)
    assert list((window.home / "runs").glob("*/before-changes/*.blend"))
    assert undone["undone"] == ["SimWorlds: grouping", "SimWorlds: add Two", "SimWorlds: add One"]


async def test_the_screenshot_shows_what_was_added(client: Client) -> None:
    before = picture(await use(client, "blender_view"))
    await build(client, "Shown", 2)
    await use(client, "blender_show", objects=["Shown"], mark=True)
    after = picture(await use(client, "blender_view", picture="window"))
    assert before.size[0] >= 800
    red, green, blue = np.moveaxis(np.asarray(after.convert("RGB")).astype(int), 2, 0)
    assert (
        np.count_nonzero((red > 200) & (green > 60) & (green < 120) & (blue < 40)) > 500
    )  # the ring around it
    await use(client, "blender_show", mark=False)
    await use(client, "blender_undo", steps=2)


async def test_looking_leaves_frame_view_and_selection(client: Client) -> None:
    await build(client, "Looked at", 1)
    await use(client, "blender_show", objects=["Cube"], frame=7)
    before = await state(client)
    for tool, arguments in (
        ("blender_scene_layout_preview", {"frame": 3}),
        ("blender_single_mesh_preview", {"object": "Cube"}),
        (
            "blender_motion_sheet_preview",
            {"actors": ["Cube"], "phases": [{"name": "a", "start": 1, "end": 12}]},
        ),
        ("blender_verify", {"rules": ["V"]}),
        ("blender_scene_state", {"detail": "full"}),
    ):
        looked = await use(client, tool, **arguments)
        assert not looked.is_error, text(looked)
    assert await state(client) == before
    assert before["frame"] == 7
    await use(client, "blender_undo", steps=2)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("while True: pass", "ran past its deadline"),
        ("import ctypes\nctypes.string_at(0)", "calls C"),
        ("import os\nos.abort()", "crashed"),
        ("bpy.ops.wm.quit_blender()", "wm.quit_blender"),
        ("bpy.ops.wm.save_as_mainfile(filepath='//other.blend')", "wm.save_as_mainfile"),
        ("try:\n    open('/tmp/simworlds-test-file', 'w')\nexcept OSError:\n    pass", "writes a file"),
        (
            "import socket\ntry:\n    socket.create_connection(('127.0.0.1', 9))\nexcept OSError:\n    pass",
            "opens a socket",
        ),
        ("bpy.data.objects['There is none']", "KeyError"),
    ],
)
async def test_harmful_code_never_arrives(client: Client, code: str, said: str) -> None:
    await never_arrives(client, code, said)


async def test_no_thread_of_ours_runs_beside_blenders_operators(client: Client, window: OpenWindow) -> None:
    """While an operator runs, Blender looks into Python's dictionaries without keeping other threads out."""
    await state(client)
    names = "[thread.name for thread in threading.enumerate()]"
    assert window.value_of(names, "threading") == "['MainThread']"


async def test_code_leaves_the_users_python_whole(client: Client, window: OpenWindow) -> None:
    told = window.root / "python.txt"
    look = LOOK_AT_PYTHON.format(str(told))
    window.choose(look)
    before = told.read_text()
    broken = await use(client, "blender_execute", code=BREAK_PYTHON)
    assert not broken.is_error, text(broken)
    window.choose(look)
    assert told.read_text() == before
    imported = await use(
        client, "blender_execute", code="import chunk, json\njson.dumps(len(chunk.__name__))"
    )
    assert not imported.is_error, text(imported)
    assert "'5'" in text(imported)


async def test_unrehearsed_code_needs_the_users_leave(client: Client) -> None:
    result = await use(client, "blender_execute", code="1+1", rehearse="off")
    assert result.is_error
    assert "the user allows no other" in text(result)


async def test_waits_until_the_user_has_finished_what_they_drag(client: Client, window: OpenWindow) -> None:
    before = await digests(client)
    window.act("mousemove", "500", "380", "click", "1", "key", "g")
    window.act("mousemove", "560", "380")
    refused = await use(client, "blender_execute", code="1+1")
    assert refused.is_error
    assert "The user is busy in Blender: the operator 'Move' is running" in text(refused)
    window.act("key", "Escape")
    assert await digests(client) == before


async def test_a_scene_that_is_too_large_to_copy_is_told(client: Client, window: OpenWindow) -> None:
    """Here a slow disk: Blender is told that it writes a byte a second."""
    name = "simworlds_live.worker.attached.files.copies"
    window.choose(f"import sys; sys.modules[{name!r}]._measured['speed'] = 1.0")
    for tool, arguments in (("blender_execute", {"code": "1+1"}), ("blender_scene_layout_preview", {})):
        refused = await use(client, tool, **arguments)
        assert refused.is_error
        assert "The scene is too large to be copied in " in text(refused)
    window.choose(f"import sys; sys.modules[{name!r}]._measured['speed'] = 1e9")
    assert not (await use(client, "blender_execute", code="1+1")).is_error


@pytest.fixture
async def large_scene(client: Client, window: OpenWindow) -> AsyncIterator[None]:
    """A scene with a mesh that takes too long to copy, beside others that do not."""
    window.require_numpy()
    code = """# a large one
import numpy
mesh = bpy.data.meshes.new("Large")
mesh.vertices.add(600_000)
mesh.vertices.foreach_set("co", numpy.zeros(1_800_000))
bpy.context.scene.collection.objects.link(bpy.data.objects.new("Large", mesh))
"""
    made = await use(client, "blender_execute", code=code)
    assert not made.is_error, text(made)
    speed = "import sys; sys.modules['simworlds_live.worker.attached.files.copies']._measured['speed'] = {}"
    window.choose(speed.format(4e6))
    yield
    window.choose(speed.format(1e9))
    await use(client, "blender_undo")


async def test_of_a_large_scene_the_part_is_rehearsed_that_code_names(
    client: Client, large_scene: None
) -> None:
    code = "cube = bpy.data.objects['Cube']\ncube.location.x = 2\nlen(bpy.context.scene.name)"
    moved = await use(client, "blender_execute", code=code)
    assert not moved.is_error, text(moved)
    assert "Rehearsed in a copy of what the code names and needs (Camera, Cube) alone" in text(moved)
    assert "other things changed" not in text(moved)
    assert "as it was before" in text(await use(client, "blender_undo"))
    added = await use(client, "blender_execute", code=BUILD.format(name="Beside", x=1))
    assert not added.is_error, text(added)
    assert "other things changed" not in text(added)
    await use(client, "blender_undo")


@pytest.mark.parametrize(
    ("code", "said"),
    [
        (
            "bpy.data.objects['Cube'].no_such",
            "This was the rehearsal in a copy of what the code names and needs",
        ),
        ("bpy.data.objects['La' + 'rge'].location", "line 1 goes through bpy.data.objects"),
        ("for one in bpy.data.objects: one.location.x = 1", "line 1 goes through bpy.data.objects"),
        ("bpy.data.objects['Large'].location.x = 1", "too large"),
        ("bpy.ops.object.select_all(action='SELECT')", "line 1 selects by bpy.ops"),
    ],
)
async def test_of_a_large_scene_nothing_unrehearsed_arrives(
    client: Client, large_scene: None, code: str, said: str
) -> None:
    refused = await use(client, "blender_execute", code=code, preflight="off")
    assert refused.is_error
    assert said in text(refused)


async def test_never_undoes_the_users_own_work(client: Client, window: OpenWindow) -> None:
    await build(client, "Theirs", 2)

    def seen() -> str:
        return window.value_of("[(*one.location, one.select_get()) for one in bpy.context.scene.objects]")

    before = seen()
    window.act("mousemove", "500", "380", "key", "a")
    assert becomes(lambda: "False" not in seen())
    selected = seen()
    window.act("key", "g", "key", "x", "key", "2", "key", "Return")
    assert becomes(lambda: seen() != selected)
    refused = await use(client, "blender_undo")
    assert refused.is_error
    assert "The user has changed the scene after SimWorlds' last step" in text(refused)
    window.act("key", "ctrl+z")
    assert becomes(lambda: seen() == selected)
    window.act("key", "ctrl+z")
    assert becomes(lambda: seen() == before)
    undone = await use(client, "blender_undo")
    assert "The scene is as it was before them" in text(undone)
    assert "The user has undone" in text(undone)


async def test_works_while_the_user_plays_the_animation(client: Client, window: OpenWindow) -> None:
    before = await digests(client)
    plays = "bpy.context.screen.is_animation_playing"
    window.act("mousemove", "500", "380", "key", "space")
    assert becomes(lambda: window.value_of(plays) == "True")
    await build(client, "Added as it plays", 1)
    undone = await use(client, "blender_undo")
    assert "The scene is as it was before them" in text(undone)
    assert window.value_of(plays) == "True", "looking and undoing stopped it"
    at = (await state(client))["frame"]
    deadline = time.monotonic() + 30
    while (await state(client))["frame"] == at:
        assert time.monotonic() < deadline, "it plays no more"
    window.act("key", "space")
    assert becomes(lambda: window.value_of(plays) == "False")
    window.choose("bpy.context.scene.frame_set(1)")
    assert await digests(client) == before


async def test_a_second_client_is_refused_and_told_why(
    client: Client, direct: Callable[[], AttachedBlender]
) -> None:
    await state(client)
    with pytest.raises(Refusal, match="SimWorlds MCP is connected to this Blender already"):
        direct().about  # noqa: B018 - connects


async def test_many_objects_are_read_in_the_copy(client: Client) -> None:
    code = """# many
for number in range(1001):
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(f"Many {number}", None))
"""
    assert not (await use(client, "blender_execute", code=code)).is_error
    read = await use(client, "blender_scene_state")
    assert "1004 objects" in text(read)
    undone = await use(client, "blender_undo")
    assert "as it was before them" in text(undone)
    assert "3 objects" in text(await use(client, "blender_scene_state", detail="summary"))


async def test_the_user_decides_what_may_be_done(client: Client, window: OpenWindow) -> None:
    chosen = "bpy.context.preferences.addons['simworlds_live'].preferences.{} = {}"
    for right, said in (("may_run", "does not allow SimWorlds to run code"), ("may_change", "only to look")):
        window.choose(chosen.format(right, False))
        refused = await use(client, "blender_execute", code="bpy.data.objects['Cube'].location.x = 1")
        window.choose(chosen.format(right, True))
        assert refused.is_error
        assert said in text(refused)


async def test_the_panel_undoes_and_stops(client: Client, window: OpenWindow) -> None:
    before = await digests(client)
    await build(client, "Undone by hand", 2)
    window.choose("bpy.ops.simworlds.undo()")
    assert await digests(client) == before
    window.choose("bpy.ops.simworlds.stop()")
    assert "The user has stopped SimWorlds in Blender's panel" in text(
        await use(client, "blender_scene_state")
    )
    window.choose("bpy.ops.simworlds.start()")
    again = await use(client, "blender_scene_state")
    assert "Attached to the user's open Blender" in text(again)


async def test_what_the_user_saves_is_told(client: Client, window: OpenWindow) -> None:
    file = window.root / "kitchen.blend"
    await build(client, "Saved", 2)
    window.choose(f"bpy.ops.wm.save_as_mainfile(filepath={str(file)!r})")
    seen = await use(client, "blender_view", picture="none")
    assert f"The user has saved the file as {file}" in text(seen)
    assert seen.structured_content is not None
    assert seen.structured_content["file"] == str(file)
    assert (await state(client))["unsaved"] is False  # Blender notes it a moment after it has saved
    looked = await use(client, "blender_scene_layout_preview")
    assert not looked.is_error, text(looked)
    assert (await state(client))["unsaved"] is False
    await use(client, "blender_undo")


async def test_another_file_is_told_and_its_undo_is_gone(client: Client, window: OpenWindow) -> None:
    await build(client, "Gone", 2)
    window.choose("bpy.ops.wm.read_homefile(app_template='')")
    said = text(await use(client, "blender_view", picture="none"))
    assert "The user has opened a new file" in said
    undone = await use(client, "blender_undo")
    assert undone.is_error
    assert "no step" in text(undone)


async def test_a_crash_is_told_and_the_next_window_is_attached_to(client: Client, window: OpenWindow) -> None:
    await build(client, "Lost", 2)
    window.kill()
    said = text(await use(client, "blender_scene_state"))
    assert "has ended: it crashed or was killed" in said
    assert "A copy from before the first change is" in said
    none = await use(client, "blender_scene_state")
    assert "No open Blender listens" in text(none)
    window.open()
    again = await use(client, "blender_scene_state")
    assert not again.is_error
    assert "Attached to the user's open Blender" in text(again)


async def test_closing_blender_is_told(client: Client, window: OpenWindow) -> None:
    window.choose("bpy.ops.wm.quit_blender()")
    window.process.wait(60)
    said = text(await use(client, "blender_scene_state"))
    assert "The user has closed Blender" in said
    assert not list((window.home / "open-blenders").glob("*.json"))
