"""When the state is written out, what is kept of it, and what becomes of the run when that fails."""

from __future__ import annotations

import re
import resource
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest
from live_session import LiveSession
from processes import of_run

from agents.blender.files import checkpoints
from agents.blender.files.checkpoints import KEPT, Checkpoint
from agents.blender.tools.execute import TOOL
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.errors import Died, Refusal
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = pytest.mark.blender

NAMES = "sorted(o.name for o in bpy.data.objects)"
CRASH = "import os\nos.abort()"


def adding(name: str) -> str:
    return f"bpy.context.collection.objects.link(bpy.data.objects.new({name!r}, None))"


def numbers(session: LiveSession) -> list[int]:
    return [one.number for one in session.blender.checkpoints.newest_first()]


@pytest.fixture(scope="module")
def _kept(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    session = LiveSession(tmp_path_factory.mktemp("checkpoints") / "run")
    yield session
    session.blender.close()


@pytest.fixture
def kept(_kept: LiveSession, monkeypatch: pytest.MonkeyPatch) -> LiveSession:
    """A Blender with an empty scene that is kept, however slow this machine is at present."""
    monkeypatch.setattr(checkpoints, "CHEAP_SECONDS", 1e6)
    _kept.empty()
    _kept.blender.keep("an empty scene")
    return _kept


@contextmanager
def full_disk() -> Iterator[None]:
    """No file that this process writes grows beyond a few bytes meanwhile."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


# When


def test_keeps_a_small_scene_after_every_changing_call(kept: LiveSession) -> None:
    before = numbers(kept)[0]
    kept.run(adding("One"))
    kept.run(adding("Two"))
    kept.blender.call("execute", {"code": "1"}, unread, timeout=20)
    assert numbers(kept)[0] == before + 2
    last = kept.blender.checkpoints.last
    assert last is not None
    assert last.path.read_bytes()[:7] in {b"BLENDER", b"\x28\xb5\x2f\xfd" + last.path.read_bytes()[4:7]}


def test_keeps_a_large_scene_less_often(kept: LiveSession, monkeypatch: pytest.MonkeyPatch) -> None:
    """A real scene of many vertices, which takes a while to write; nothing is cheap any more."""
    monkeypatch.setattr(checkpoints, "CHEAP_SECONDS", 0.0)
    kept.run(
        "import numpy\nmesh = bpy.data.meshes.new('Large')\nmesh.vertices.add(400_000)\n"
        "mesh.vertices.foreach_set('co', numpy.random.random(1_200_000))\n"
        "bpy.context.collection.objects.link(bpy.data.objects.new('Large', mesh))"
    )
    large = kept.blender.keep("a large scene")
    assert large.bytes > 3_000_000
    assert kept.blender.checkpoints._cost > 0
    cost = kept.blender.checkpoints._cost = 0.25  # as long as the calls that follow cannot take
    kept.run(adding("Quick"))
    kept.run(adding("Quick, too"))
    assert numbers(kept)[0] == large.number
    assert kept.blender.checkpoints.unkept == 2
    kept.run(f"import time\ntime.sleep({cost * checkpoints.PATIENCE})")
    assert numbers(kept)[0] == large.number + 1
    assert kept.blender.checkpoints.unkept == 0
    kept.blender.checkpoints._cost = 0.5
    kept.run(adding("Lost"))
    with pytest.raises(Died, match=r"the changes of the last call before it are lost too"):
        kept.use(TOOL, code=CRASH)
    assert kept.run(NAMES) == ["Large", "Quick", "Quick, too"]


def test_keeps_even_large_scenes_before_code_to_be_undone(
    kept: LiveSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept.run(adding("Kept"))
    monkeypatch.setattr(checkpoints, "CHEAP_SECONDS", 0.0)
    monkeypatch.setattr(checkpoints, "PATIENCE", 1e6)
    kept.run(adding("Not yet kept"))
    found = kept.use(TOOL, code=f"{adding('Half')}\n1 / 0", on_error="restore")
    assert "The scene was restored from checkpoint" in found.text
    assert kept.run(NAMES) == ["Kept", "Not yet kept"]


def test_undo_hint_counts_the_calls_that_it_undoes(
    kept: LiveSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    last = kept.blender.checkpoints.last
    assert last is not None
    found = kept.use(TOOL, code="1 / 0")
    assert f"To undo it: blender_load(checkpoint={last.number}), if you have" in found.text
    last = kept.blender.keep("now")
    monkeypatch.setattr(checkpoints, "CHEAP_SECONDS", 0.0)
    monkeypatch.setattr(checkpoints, "PATIENCE", 1e6)
    kept.run(adding("One"))
    kept.run(adding("Two"))
    found = kept.use(TOOL, code="1 / 0")
    assert (
        f"To undo it and the 2 calls before it: blender_load(checkpoint={last.number}), if you have"
        in found.text
    )


def test_checkpoints_run_no_save_handlers(kept: LiveSession) -> None:
    code = "def never(*_):\n    while True: pass\nbpy.app.handlers.save_pre.append(never)\n" + adding("Kept")
    kept.use(TOOL, code=code)
    assert kept.blender.keep("a handler that never returns").number == numbers(kept)[0]
    assert kept.run("len(bpy.app.handlers.save_pre)") == 1


def test_keeps_an_unchanged_scene_only_once(kept: LiveSession) -> None:
    first = kept.blender.keep("once")
    assert kept.blender.keep("twice") == first


# What is kept


def test_keeps_the_newest_checkpoints(kept: LiveSession) -> None:
    for number in range(KEPT + 3):
        kept.run(adding(str(number)))
    assert len(numbers(kept)) == KEPT
    assert numbers(kept) == sorted(numbers(kept), reverse=True)
    files = sorted(int(path.stem) for path in kept.blender.folder.checkpoints.iterdir())
    assert files == sorted(numbers(kept))
    gone = numbers(kept)[-1] - 1
    with pytest.raises(Refusal, match=rf"There is no checkpoint {gone}\. Available: {gone + 1}, "):
        kept.blender.restore(gone)


def test_keeps_fewer_large_checkpoints(kept: LiveSession, monkeypatch: pytest.MonkeyPatch) -> None:
    kept.run(adding("One"))
    last = kept.blender.checkpoints.last
    assert last is not None
    monkeypatch.setattr(checkpoints, "KEPT_BYTES", 5 * last.bytes + last.bytes // 2)
    kept.run(adding("Two"))
    assert len(numbers(kept)) == 5
    monkeypatch.setattr(checkpoints, "KEPT_BYTES", 1)
    kept.run(adding("Three"))
    assert len(numbers(kept)) == checkpoints.KEPT_LEAST


def test_going_back_makes_a_new_checkpoint(kept: LiveSession) -> None:
    kept.run(adding("One"))
    one = kept.blender.keep("one")
    kept.run(adding("Two"))
    two = kept.blender.keep("two")
    assert kept.blender.restore(one.number) == one
    assert kept.run(NAMES) == ["One"]
    with pytest.raises(Died, match=r"started from checkpoint \d+ \(.*as it was before"):
        kept.use(TOOL, code=CRASH)
    assert kept.run(NAMES) == ["One"]
    kept.blender.restore(two.number)
    assert kept.run(NAMES) == ["One", "Two"]


def test_restores_the_whole_state(kept: LiveSession) -> None:
    """Paths, the frame, the mode's object, data without users and what was packed."""
    look = (
        "s = bpy.context.scene\n(s.frame_current, s.render.filepath, bpy.data.images['i'].filepath,"
        " bpy.data.images['i'].packed_file is not None, [round(v, 3) for v in bpy.context.object.location],"
        " bpy.context.object.name)"
    )
    kept.run(
        "bpy.ops.mesh.primitive_cube_add(location=(1, 2, 3))\ns = bpy.context.scene\ns.frame_current = 42\n"
        "s.render.filepath = '//renders/one_'\nimage = bpy.data.images.new('i', 8, 8)\nimage.pack()\n"
        "image.filepath = '//textures/i.png'\nimage.use_fake_user = True"
    )
    before = kept.run(look)
    assert before[0] == 42
    assert before[1:3] == ("//renders/one_", "//textures/i.png")
    kept.blender.keep("a state")
    kept.blender.kill()
    assert kept.run(look) == before
    kept.run("s = bpy.context.scene\ns.frame_current = 1\ns.render.filepath = ''")
    kept.blender.restore(numbers(kept)[1])
    assert kept.run(look) == before


def test_relative_paths_survive_saving_elsewhere(kept: LiveSession) -> None:
    kept.run(
        "import os\nos.makedirs('sub', exist_ok=True)\n"
        "bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath('sub/other.blend'))\n"
        "image = bpy.data.images.new('i', 8, 8)\nimage.use_fake_user = True\n"
        "image.filepath_raw = '//i.png'\nimage.file_format = 'PNG'\nimage.save()"
    )
    assert (kept.blender.folder.workspace.mount / "sub" / "i.png").is_file()
    kept.blender.keep("elsewhere")
    kept.blender.kill()
    assert kept.run("import os\nos.path.isfile(bpy.path.abspath(bpy.data.images['i'].filepath))") is True
    assert kept.run("bpy.data.filepath") == str(kept.blender.folder.workspace.mount / "scene.blend")


# When it fails


def test_full_disk_costs_one_checkpoint_and_is_reported(kept: LiveSession) -> None:
    kept.run(adding("Kept"))
    last = kept.blender.keep("before")
    content = last.path.read_bytes()
    with full_disk():
        found = kept.use(TOOL, code=f"{adding('Unkept')}\n6 * 7")
    assert found.data["value"] == "42"
    assert not found.failed
    assert "No checkpoint could be taken: " in found.text
    assert "File too large" in found.text, found.text
    assert f"{last} is unchanged" in found.text
    assert numbers(kept)[0] == last.number
    assert last.path.read_bytes() == content
    assert not list(kept.blender.folder.checkpoints.glob(".*"))
    # With room again, the next call keeps both.
    found = kept.use(TOOL, code=adding("Later"))
    assert "could be taken" not in found.text
    kept.blender.kill()
    assert kept.run(NAMES) == ["Kept", "Later", "Unkept"]


def test_reports_loss_of_what_did_not_fit_on_disk(kept: LiveSession) -> None:
    kept.run(adding("Kept"))
    kept.blender.keep("before")
    with full_disk():
        kept.run(adding("Unkept"))
    with pytest.raises(Died, match=r"the changes of the last call before it are lost too"):
        kept.use(TOOL, code=CRASH)
    assert kept.run(NAMES) == ["Kept"]


def test_explicit_checkpoint_fails_on_a_full_disk(kept: LiveSession) -> None:
    kept.blender.checkpoints.changed(0.0)
    with (
        full_disk(),
        pytest.raises(Refusal, match=r"No checkpoint could be taken: .*File too large.*Blender still runs"),
    ):
        kept.blender.keep("now")
    before = kept.blender.inner_pid
    assert kept.run("1 + 1") == 2
    assert kept.blender.inner_pid == before


def test_reports_a_scene_too_large_to_write(tmp_path: Path) -> None:
    """Blender itself cannot write it: it is confined to small files."""
    session = LiveSession(tmp_path / "run", sandbox=best_sandbox(None, ResourceLimits(file_size=3 << 20)))
    try:
        found = session.use(
            TOOL,
            code="import numpy\nmesh = bpy.data.meshes.new('Large')\nmesh.vertices.add(500_000)\n"
            "mesh.vertices.foreach_set('co', numpy.random.random(1_500_000))\nmesh.use_fake_user = True",
        )
        assert "No checkpoint could be taken" in found.text
        assert re.search(r"File too large|A file may have 3 MB at most", found.text), found.text
        assert session.run("len(bpy.data.meshes['Large'].vertices)") == 500_000
        assert numbers(session) == [1]
    finally:
        session.blender.close()
    assert of_run(tmp_path / "run") == []


def test_skips_checkpoints_that_cannot_be_opened_and_removes_half_written_ones(tmp_path: Path) -> None:
    session = LiveSession(tmp_path / "run")
    for name in ("One", "Two"):
        session.run(adding(name))
        session.blender.keep(name)
    session.run(adding("Three"))
    session.blender.close()
    files = sorted((tmp_path / "run" / "checkpoints").iterdir())
    files[-1].write_bytes(files[-1].read_bytes()[:2000])
    files[-2].write_bytes(b"no blend at all")
    (tmp_path / "run" / "checkpoints" / ".000009.blend.part").write_bytes(b"half")
    (tmp_path / "run" / "workspace" / "scene.blend@").write_bytes(b"half")
    (tmp_path / "run" / "checkpoints" / "notes.txt").write_text("mine")
    again = LiveSession(tmp_path / "run")
    try:
        assert again.run(NAMES) == ["One"]
        assert not list((tmp_path / "run").rglob("*.part"))
        assert not list((tmp_path / "run").rglob("*.blend@"))
        assert (tmp_path / "run" / "checkpoints" / "notes.txt").exists()
        last = again.blender.checkpoints.last
        assert last is not None
        assert last.number > int(files[-1].stem)
        # Where Blender stands is the newest now: a crash does not go through the broken ones again.
        with pytest.raises(Died, match="the scene as it was before"):
            again.use(TOOL, code=CRASH)
        assert again.run(NAMES) == ["One"]
    finally:
        again.blender.close()


def test_describes_a_checkpoint(kept: LiveSession) -> None:
    kept.use(TOOL, code="tower = 'high'")
    last = kept.blender.checkpoints.last
    assert isinstance(last, Checkpoint)
    assert str(last) == f"checkpoint {last.number} (after \"tower = 'high'\", {last.taken:%H:%M:%S})"
