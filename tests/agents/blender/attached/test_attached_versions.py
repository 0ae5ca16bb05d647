"""The extension in Blenders of several versions, without a window: ``bpy`` packages that turn its timer themselves."""

from __future__ import annotations

import os
import signal
import subprocess
import zipfile
from typing import TYPE_CHECKING

import pytest
from attached_client import build_and_undo, listens, never_arrives, server, state, text, use
from mcp import Client
from serving import COMMAND

from agents.blender import extension
from simworlds.releases import releases
from simworlds.sandbox.errors import NotInstalled
from simworlds.sandbox.runtime import environment_of_others, find_runtime
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator
    from pathlib import Path

    from simworlds.sandbox.runtime import Runtime

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

_OPEN = """
import sys, time
import bpy, addon_utils
bpy.ops.wm.read_homefile(use_factory_startup=True)
sys.path.insert(0, sys.argv[1])
addon_utils.enable("simworlds_live", default_set=True)
bpy.ops.ed.undo_push(message="Original")  # as a window does
bpy.ops.simworlds.start()
from simworlds_live.worker.attached.panel import _runner
while _runner().listener is not None:
    time.sleep(_runner().tick() or 0)
"""


class Windowless:
    """An open Blender of a version; everything of its user's is below ``root``."""

    def __init__(self, root: Path, runtime: Runtime) -> None:
        self.root, self.home = root, root / "home"
        self.home.mkdir()
        for shared in ("runtimes", "kb"):
            (self.home / shared).symlink_to(home_folder() / shared)
        self.environment = {
            **{name: value for name, value in environment_of_others().items() if name != "BLENDER_EXE"},
            "SIMWORLDS_HOME": str(self.home),
            "TMPDIR": str(root),
        }
        self.command = [*COMMAND, "--attach", "open"]
        with zipfile.ZipFile(extension.build(root)) as archive:
            archive.extractall(root / "addons")
        words = [str(runtime.executable), "-c", _OPEN, str(root / "addons")]
        with (root / "blender.log").open("wb") as log:
            self.process = subprocess.Popen(
                words, env=self.environment, stdout=log, stderr=log, start_new_session=True
            )
        listens(self.process, self.home, root / "blender.log", 60)

    def close(self) -> None:
        """Ends Blender."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module", params=[row.minor for row in releases()])
def blender(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Windowless]:
    version = request.param
    try:
        runtime = find_runtime(version, home=home_folder(), install=False)
    except NotInstalled:
        pytest.skip(
            f"Blender {version} is not installed here (simworlds doctor --blender {version} --install)"
        )
    opened = Windowless(tmp_path_factory.mktemp(f"blender-{version}"), runtime)
    yield opened
    opened.close()


@pytest.fixture(scope="module")
async def client(blender: Windowless) -> AsyncIterator[Client]:
    async with Client(server(blender), read_timeout_seconds=200) as connected:
        yield connected


async def test_builds_step_by_step_and_undoes_all(client: Client) -> None:
    await build_and_undo(client)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        pytest.param("while True: pass", "ran past its deadline", marks=pytest.mark.whole),
        pytest.param("import os\nos.abort()", "crashed", marks=pytest.mark.whole),
        ("bpy.data.objects['There is none']", "KeyError"),
    ],
)
async def test_harmful_code_never_arrives(client: Client, code: str, said: str) -> None:
    await never_arrives(client, code, said)


async def test_looking_leaves_the_users_state(client: Client) -> None:
    before = await state(client)
    for tool, arguments in (
        ("blender_scene_layout_preview", {"frame": 3}),
        ("blender_single_mesh_preview", {"object": "Cube"}),
        ("blender_verify", {"rules": ["V"]}),
        ("blender_scene_state", {"detail": "full"}),
    ):
        looked = await use(client, tool, **arguments)
        assert not looked.is_error, text(looked)
    assert await state(client) == before


async def test_a_crash_is_told(client: Client, blender: Windowless) -> None:
    os.killpg(blender.process.pid, signal.SIGKILL)
    blender.process.wait()
    gone = await use(client, "blender_view", picture="none")
    assert gone.is_error
    assert "has ended: it crashed or was killed" in text(gone)
