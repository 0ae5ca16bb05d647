"""``simworlds mcp --as blender-mcp``, spoken to by clients that keep to the protocol and by such that do not."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from addon_server import AddonServer, RawClient, message
from PIL import Image
from serving import COMMAND, REPO, await_file, blenders, environment, have_ended

from agents.blender.drop_in.connections import MOST

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.blender

EMPTY = "import bpy\nbpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)"
CUBE = f"{EMPTY}\nbpy.ops.mesh.primitive_cube_add(location=(1.234, 0, 2))\nbpy.context.object.name = 'Würfel'"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AddonServer]:
    """A server for all tests that leave it running."""
    with AddonServer(tmp_path_factory.mktemp("home")) as started:
        yield started


@pytest.fixture
def client(server: AddonServer) -> Iterator[RawClient]:
    with server.client() as connected:
        yield connected


# The commands


def test_scene_and_objects_are_told_as_the_add_on_tells_them(client: RawClient) -> None:
    client.run(f"{CUBE}\nmat = bpy.data.materials.new('Rot')\nbpy.context.object.data.materials.append(mat)")
    assert client.result("get_scene_info") == {
        "name": "Scene",
        "object_count": 1,
        "objects": [{"name": "Würfel", "type": "MESH", "location": [1.23, 0.0, 2.0]}],
        "materials_count": 1,
    }
    told = client.result("get_object_info", name="Würfel")
    assert told["location"] == pytest.approx([1.234, 0, 2])
    assert told["world_bounding_box"] == [pytest.approx([0.234, -1, 1]), pytest.approx([2.234, 1, 3])]
    assert told["mesh"] == {"vertices": 8, "edges": 12, "polygons": 6}
    assert (told["rotation"], told["scale"], told["visible"]) == ([0, 0, 0], [1, 1, 1], True)
    assert told["materials"] == ["Rot"]
    items = client.result("list_scene_items", query="r", limit=5)["items"]
    assert [(item["kind"], item["name"]) for item in items] == [("material", "Rot"), ("object", "Würfel")]
    missing = client.ask("get_object_info", name="Wurfel")
    assert missing["status"] == "error"
    assert missing["message"] == "Object not found: Wurfel. Nearest: 'Würfel'."


def test_only_the_first_ten_objects_are_listed_and_odd_numbers_are_null(client: RawClient) -> None:
    client.run(
        f"{EMPTY}\nfor i in range(12): bpy.context.scene.collection.objects.link(bpy.data.objects.new(str(i), None))\n"
        "bpy.data.objects['0'].location.x = float('nan')"
    )
    told = client.result("get_scene_info")
    assert (told["object_count"], len(told["objects"])) == (12, 10)
    assert told["objects"][0]["location"] == [None, 0.0, 0.0]


def test_code_gives_what_it_prints_or_its_exception(client: RawClient) -> None:
    client.run(EMPTY)
    assert client.run("print('grün', len(bpy.data.objects))") == "grün 0\n"
    assert client.run("print('x' * 500_000)") == "x" * 500_000 + "\n"
    assert client.run("import os; os.write(1, b'Blender says')\nprint('and I')") == "and I\n"
    reply = client.ask("execute_code", code="print('before')\nbpy.nothing")
    told = json.loads(reply["message"])
    assert (told["exception_type"], told["printed"]) == ("AttributeError", "before\n")
    assert "nothing" in told["message"]
    assert "line 2" in told["traceback"]
    assert json.loads(client.ask("execute_code", code="x = (")["message"])["exception_type"] == "SyntaxError"
    assert client.ask("execute_code", code="import sys; sys.exit(1)")["status"] == "error"
    assert client.run("print(1)") == "1\n"


def test_integrations_are_off_and_say_so(client: RawClient) -> None:
    for name in ("polyhaven", "hyper3d", "sketchfab", "polypizza", "hunyuan3d", "meshy", "tripo"):
        told = client.result(f"get_{name}_status")
        assert told["enabled"] is False
        assert "no network" in told["message"]
    for command in ("search_polyhaven_assets", "create_rodin_job", "set_texture", "import_generated_asset"):
        reply = client.ask(command, query="chair")
        assert reply["status"] == "error"
        assert "is off" in reply["message"]
    assert (
        client.result("get_telemetry_consent") == client.result("set_telemetry_consent") == {"consent": False}
    )
    assert "error" in client.result("set_telemetry_consent", consent=True)
    about = client.result("get_addon_info")
    assert {"execute_code", "get_viewport_screenshot"} <= set(about["capabilities"])
    assert client.result("ping") == {"pong": True}
    assert client.ask("get_world_state_snapshot")["message"].startswith("Unknown command type: get_world")


# Screenshots


def test_a_screenshot_shows_the_scene_at_the_path_that_was_asked_for(
    server: AddonServer, client: RawClient
) -> None:
    client.run(CUBE)
    path = server.temporary / "blender_screenshot_1.png"
    told = client.result("get_viewport_screenshot", max_size=200, filepath=str(path), format="png")
    assert (told["success"], told["width"], told["height"], told["filepath"]) == (True, 200, 200, str(path))
    with Image.open(path) as picture:
        assert picture.size == (200, 200)
        assert len(picture.convert("L").resize((100, 100)).getcolors() or ()) > 3
    client.run(EMPTY)
    path.unlink()
    client.result("get_viewport_screenshot", filepath=str(path))
    assert path.exists()


@pytest.mark.parametrize("path", ["/etc/shot.png", "{}/a.txt", "{}/../a.png", "shot.png"])
def test_a_screenshot_goes_nowhere_else(server: AddonServer, client: RawClient, path: str) -> None:
    reply = client.ask("get_viewport_screenshot", filepath=path.replace("{}", str(server.temporary)))
    assert reply["status"] == "error"
    assert "--screenshots" in reply["message"]
    assert not Path("/etc/shot.png").exists()


def test_a_picture_that_code_renders_arrives_where_the_code_says(
    server: AddonServer, client: RawClient
) -> None:
    path = server.temporary / "render.png"
    said = client.run(
        f"{CUBE}\nbpy.ops.object.camera_add()\ns = bpy.context.scene\ns.camera = bpy.context.object\n"
        "s.render.engine = 'BLENDER_WORKBENCH'\ns.render.resolution_x = s.render.resolution_y = 32\n"
        f"s.render.filepath = {str(path)!r}\nbpy.ops.render.render(write_still=True)\nprint(s.render.filepath)"
    )
    assert said == f"{path}\n"
    with Image.open(path) as picture:
        assert picture.size == (32, 32)
    path.unlink()
    client.run("bpy.ops.render.render(write_still=True)")
    assert path.exists()
    assert client.run(f"print(bpy.data.images.load({str(path)!r}).name)") == "render.png\n"
    reply = client.ask("execute_code", code=f"open({str(server.temporary / 'x.txt')!r}, 'w')")
    assert "PermissionError" in reply["message"] or "FileNotFoundError" in reply["message"]
    assert not (server.temporary / "x.txt").exists()


# Bad input


def test_messages_may_come_in_any_pieces(client: RawClient) -> None:
    data = json.dumps(
        {"type": "execute_code", "params": {"code": "print('ä🧊')"}}, ensure_ascii=False
    ).encode()
    client.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    for byte in data:
        client.send(bytes([byte]))
    assert client.receive()["result"]["result"] == "ä🧊\n"
    client.send(data + b"\n" + message("ping") + b" " + message("execute_code", code="print(2)"))
    replies = [client.receive()["result"] for _ in range(3)]
    assert replies[1] == {"pong": True}
    assert [reply["result"] for reply in (replies[0], replies[2])] == ["ä🧊\n", "2\n"]


@pytest.mark.parametrize(
    ("data", "word"),
    [
        (b"{'type': 1}", "not valid JSON"),
        (b'{"type": "\xff"}', "not UTF-8"),
        (b"{}", "no command"),
        (b'{"type": 3}', "no command"),
        (b'{"type": "execute_code", "params": [1]}', "not a JSON object"),
        (b'{"type": "execute_code", "params": {"code": 1}}', "code"),
        (b'{"type": "execute_code", "params": {"code": "\\ud800"}}', "code"),
        (b'{"type": "get_object_info", "params": {"nam": "x"}}', "nam"),
        (b'{"type": "dance"}', "Unknown command type: dance"),
        (b'{"n": ' + b"9" * 5000 + b"}", "cannot be read"),
    ],
)
def test_a_wrong_message_is_told_and_the_next_one_answered(client: RawClient, data: bytes, word: str) -> None:
    client.send(data)
    reply = client.receive()
    assert reply["status"] == "error"
    assert word in reply["message"]
    assert "Traceback" not in reply["message"]
    assert client.result("ping")


@pytest.mark.parametrize(
    ("data", "word"),
    [
        (b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n" + message("execute_code", code="1"), "'POST /"),
        (b'{"type": "execute_code", "params": {"code": "' + b"x" * 9_000_000, "longer than"),
        (b'{"a":' * 1000, "nests"),
    ],
)
def test_what_is_no_message_ends_its_connection_alone(
    server: AddonServer, client: RawClient, data: bytes, word: str
) -> None:
    with server.client() as rude:
        rude.send(data)
        assert word in rude.receive()["message"]
        assert rude.is_closed()
    assert client.result("ping")


def test_clients_that_vanish_are_not_missed(server: AddonServer, client: RawClient) -> None:
    client.run(EMPTY)
    for data in (b"", b'{"type": "exe', message("get_scene_info"), message("ping") * 3000):
        gone = server.client()
        gone.send(data)
        gone.vanish()
    gone = server.client()
    where = client.run("import os; print(os.getcwd())").strip()
    gone.send(
        message(
            "execute_code",
            code="open('begun', 'w').close()\nimport time\ntime.sleep(1)\nbpy.context.scene['x'] = 1",
        )
    )
    await_file(Path(where) / "begun")
    gone.vanish()
    assert client.run("print(bpy.context.scene['x'])") == "1\n"


def test_many_clients_each_get_their_own_replies(server: AddonServer) -> None:
    def use(number: int) -> list[str]:
        with server.client() as one:
            return [one.run(f"print({number}, {turn})") for turn in range(4)]

    with ThreadPoolExecutor(8) as threads:
        for number, said in enumerate(threads.map(use, range(8))):
            assert said == [f"{number} {turn}\n" for turn in range(4)]


def test_idle_connections_do_not_keep_others_out(server: AddonServer) -> None:
    idle = [server.client() for _ in range(MOST + 10)]
    assert idle[-1].result("ping")
    with server.client() as late:
        assert late.run("print(1)") == "1\n"
    for one in idle:
        one.socket.close()


# Code that breaks Blender


@pytest.fixture(scope="module")
def hasty(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AddonServer]:
    """A server whose code has four seconds."""
    with AddonServer(tmp_path_factory.mktemp("hasty"), "--timeout", "4") as started:
        yield started


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("while True: pass", ("ran past its deadline of 4 s", "--timeout")),
        ("import os; os.abort()", ("crashed (SIGABRT)",)),
        pytest.param("import os; os._exit(0)", ("ended from inside",), marks=pytest.mark.whole),
        pytest.param("import ctypes; ctypes.string_at(0)", ("SIGSEGV",), marks=pytest.mark.whole),
    ],
)
def test_code_that_ends_blender_costs_its_own_call(
    hasty: AddonServer, code: str, words: tuple[str, ...]
) -> None:
    with hasty.client() as client:
        client.run(f"{CUBE}\nbpy.context.scene['kept'] = 1")
        reply = client.ask("execute_code", code=f"import bpy\nbpy.context.scene['kept'] = 2\n{code}")
        assert reply["status"] == "error"
        assert all(word in reply["message"] for word in words), reply["message"]
        assert "the scene as it was before" in reply["message"]
        assert client.run("print(bpy.context.scene['kept'])") == "1\n"
        assert client.result("get_scene_info")["object_count"] == 1


def test_a_hanging_call_does_not_keep_others_from_what_needs_no_blender(hasty: AddonServer) -> None:
    with hasty.client() as hangs, hasty.client() as other:
        hangs.send(message("execute_code", code="while True: pass"))
        assert other.result("ping")
        assert other.result("get_scene_info")["name"] == "Scene"
        assert "deadline" in hangs.receive()["message"]


# Beginning and end


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.whole)])
def test_a_signal_ends_it_in_mid_call_and_the_scene_goes_on(tmp_path: Path, number: signal.Signals) -> None:
    run = ["--run", str(tmp_path / "run")]
    with AddonServer(tmp_path / "home", *run) as server, server.client() as client:
        client.run(f"{CUBE}\nbpy.context.scene['kept'] = 1")
        client.send(message("execute_code", code="open('begun', 'w').close()\nwhile True: pass"))
        await_file(tmp_path / "run" / "workspace" / "begun")
        started = blenders(server.process.pid)
        assert started
        code, out, err = server.end(number)
        assert (code, out) == (0, "")
        assert "Traceback" not in err
        assert f"--run {tmp_path / 'run'}" in err
        assert have_ended(started)
        assert client.receive()["status"] == "error"
    with AddonServer(tmp_path / "home", *run) as server, server.client() as client:
        assert client.run("print(bpy.context.scene['kept'], len(bpy.data.objects))") == "1 1\n"


def refused(home: Path, *options: str) -> str:
    """What the command says that does not start."""
    done = subprocess.run(
        [*COMMAND, *options],
        env=environment(home),
        cwd=REPO,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    return done.stderr


def test_a_port_that_is_taken_is_told(server: AddonServer, tmp_path: Path) -> None:
    said = refused(tmp_path, "--as", "blender-mcp", "--port", str(server.port))
    assert f"Port {server.port} is taken" in said
    assert "BLENDER_PORT" in said


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--as", "blender-mcp", "--http"], "--http does not go with"),
        (["--as", "blender-mcp", "--host", "0.0.0.0"], "--host needs --http"),
        (["--timeout", "5"], "--timeout needs --as"),
        (["--port", "5"], "--port needs --http"),
        (["--as", "other"], "blender-mcp"),
    ],
)
def test_options_that_do_not_go_together_are_refused(tmp_path: Path, options: list[str], word: str) -> None:
    assert word in refused(tmp_path, *options)
