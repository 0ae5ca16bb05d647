"""Kills at random moments: the next call works, what was kept is there, and nothing is left behind."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from live_session import LiveSession
from processes import becomes, of_run
from whole import IS_WHOLE, examples

from agents.blender.tools.execute import TOOL
from simworlds.sandbox.errors import BlenderError, Lost

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.blender

KILLS = 8 if IS_WHOLE else 2  # of each of the five, half of them of the process around Blender
SEED = 20722

# A scene that takes a moment to write, and has something to bake and to render.
SCENE = """
import numpy
mesh = bpy.data.meshes.new('Large')
mesh.vertices.add(60_000)
mesh.vertices.foreach_set('co', numpy.random.default_rng(1).random(180_000, dtype=numpy.float32) * 0.1)
scene = bpy.context.scene
scene.collection.objects.link(bpy.data.objects.new('Large', mesh))
bpy.ops.mesh.primitive_plane_add(size=10)
bpy.ops.rigidbody.object_add(type='PASSIVE')
for height in range(8):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(height % 2 * 0.4, 0, 2 + 1.2 * height))
    bpy.ops.rigidbody.object_add()
scene.rigidbody_world.point_cache.frame_end = 60
scene.camera = bpy.data.objects.new('Camera', bpy.data.cameras.new('Camera'))
scene.camera.location.z = 20
scene.collection.objects.link(scene.camera)
scene.render.engine = 'CYCLES'
scene.cycles.samples = 4
scene.render.resolution_x = scene.render.resolution_y = 64
scene.render.filepath = '//still.png'
scene['round'] = 0
"""
CODE = {
    "execute": "for i in range(20):\n    bpy.data.objects['Large'].location.x = i\n"
    "    bpy.context.view_layer.update()\n    bpy.ops.mesh.primitive_monkey_add()",
    "bake": "bpy.ops.ptcache.bake_all(bake=True)",
    "render": "bpy.ops.render.render(write_still=True)",
    "save": "for _ in range(3): bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//saved.blend'), copy=True)",
}
VICTIMS = [*CODE, "checkpoint"]


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    session = LiveSession(tmp_path_factory.mktemp("kills") / "run")
    session.run(SCENE)
    session.blender.keep("the scene")
    yield session
    session.blender.close()


def begin(session: LiveSession, victim: str, number: int) -> None:
    """What is to be killed: it changes the scene's mark first, so that half of it can be told from all."""
    if victim == "checkpoint":
        session.run(f"bpy.context.scene['round'] = {number}")
        session.blender.checkpoints.changed(0.0)
        session.blender.keep(f"round {number}")
    else:
        session.use(TOOL, code=f"bpy.context.scene['round'] = {number}\n{CODE[victim]}", timeout=60)


def family(number: int | None) -> set[int]:
    """A process and all below it."""
    try:
        children = Path(f"/proc/{number}/task/{number}/children").read_text().split()
    except OSError:
        return set()
    return {number}.union(*(family(int(child)) for child in children))


def opens_elsewhere(paths: list[Path], key: str) -> list[int]:
    """The marks of scenes, read by a Blender that knows of nothing but the files; -2 of the empty one before them."""
    code = (
        f"import bpy, os, sys\nfor path in sys.argv[1:]:\n    bpy.ops.wm.open_mainfile(filepath=path)\n"
        f"    mark = bpy.context.scene.get({key!r}, -2)\n"
        f"    assert mark == -2 or len(bpy.data.meshes['Large'].vertices) == 60_000\n"
        f"    sys.stderr.write(f'{{mark}}\\n')\nos._exit(0)"
    )
    words = [sys.executable, "-c", code, *map(str, paths)]
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"TMPDIR": folder}
        done = subprocess.run(
            words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True
        )
    marks = [int(line) for line in done.stderr.split() if line.lstrip("-").isdigit()]
    assert -2 not in marks[:-1]
    return marks


# Baking, rendering and saving are code in a call, as what stands for them here.
@pytest.mark.parametrize(
    "victim",
    [
        pytest.param(one, marks=() if one in {"execute", "checkpoint"} else pytest.mark.whole)
        for one in VICTIMS
    ],
)
def test_kills_at_random_moments_cost_at_most_the_call(killed: LiveSession, victim: str) -> None:
    session, blender = killed, killed.blender
    root = blender.folder.root
    chance = random.Random(f"{SEED} {victim}")
    blender.kill()
    session.run("1")
    started = time.monotonic()
    begin(session, victim, -1)
    takes = time.monotonic() - started
    blender.keep("before the kills")
    survived = 0
    # Under load a scene takes long to write, and not every call leaves a checkpoint: a kill goes back to the last one.
    mark = kept = -1
    for number in range(KILLS):
        hit, before = blender.pid if number % 2 else blender.inner_pid, family(blender.pid)
        killer = threading.Timer(chance.uniform(0, 1.1 * takes), os.kill, (hit, signal.SIGKILL))
        killer.start()
        fault = None
        try:
            begin(session, victim, number)
        except Lost as error:
            fault = str(error)
        killer.join()
        unkept = blender.checkpoints.unkept
        blender.take_note()
        # Behind bubblewrap, Blender ends a little after it.
        assert becomes(lambda before=before: not before & set(of_run(root)))
        found = session.run("bpy.context.scene['round']")
        if fault is None:
            survived += 1
            lost = unkept and found == kept and "lost too" in blender.take_note()
            assert found == number or lost
        else:
            assert "A new Blender was started from checkpoint" in fault
            # The round was kept already if it was its second checkpoint that was killed.
            assert found in ({kept, number} if victim == "checkpoint" else {kept}), (
                f"{victim} {number}: {fault}"
            )
            assert kept == mark or "lost too" in fault
        mark = found
        kept = kept if blender.checkpoints.unkept else found
        assert becomes(lambda: set(of_run(root)) == family(blender.pid)), (
            "a process of an earlier Blender is left"
        )
    assert survived < KILLS, "no kill came in time"
    blender.keep("after the kills")
    files = [checkpoint.path for checkpoint in blender.checkpoints.newest_first()]
    assert opens_elsewhere(files, "round")[0] == mark


def test_kills_while_another_blender_is_being_started(killed: LiveSession) -> None:
    """Whatever belongs to the run is killed, again and again, until it comes up."""
    session, blender = killed, killed.blender
    chance = random.Random(SEED)
    blender.keep("before the kills")
    before = session.run("bpy.context.scene['round']")
    for _ in range(examples(4)):
        begun = blender.pid
        assert begun is not None
        os.kill(begun, signal.SIGKILL)

        def kill_the_next(begun: int = begun, after: float = chance.uniform(0, 0.5)) -> None:
            assert becomes(lambda: bool(set(of_run(blender.folder.root)) - {begun}))
            time.sleep(after)
            for number in of_run(blender.folder.root):
                try:
                    os.kill(number, signal.SIGKILL)
                except ProcessLookupError:
                    continue

        assert becomes(lambda begun=begun: begun not in of_run(blender.folder.root))
        killer = threading.Thread(target=kill_the_next)
        killer.start()
        fault = None
        try:
            session.run("1")
        except BlenderError as error:
            fault = str(error)
        killer.join()
        assert fault is None or "started from checkpoint" in fault
        assert session.run("bpy.context.scene['round']") == before


def test_kills_leave_no_files_or_processes(killed: LiveSession) -> None:
    root = killed.blender.folder.root
    killed.blender.close()
    assert becomes(lambda: of_run(root) == [])
    assert sorted(path.name for path in root.iterdir()) == [".lock", "checkpoints", "workspace"]
    left = {path.name for path in root.rglob("*") if path.is_file() and path.suffix != ".blend"}
    assert left <= {".lock", "still.png"}
    files = sorted((root / "checkpoints").iterdir(), reverse=True)
    assert all(path.suffix == ".blend" for path in files)
    marks = opens_elsewhere(files, "round")
    assert len(marks) == len(files)
