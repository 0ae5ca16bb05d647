"""Systems on a miniature set in real Blender: what is rendered, what is left out and why, what a kill leaves."""

from __future__ import annotations

import dataclasses
import json
import shutil
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import clip_sample
import commands
import pytest
import team
from click.testing import CliRunner
from fake_messages_api import FakeMessagesAPI
from PIL import Image
from places import REPO
from whole import IS_WHOLE

from bench.blenderbench.errors import BadResults
from bench.blenderbench.n_clip import Tower, clip_distance
from bench.blenderbench.photometric import photometric_loss
from bench.blenderbench.pictures import read_picture
from bench.blenderbench.results import Score, TaskRecord, read, read_run, task_folder
from bench.blenderbench.run import run
from bench.blenderbench.systems import RendersFolder, UneditedStart
from bench.blenderbench.task_scenes import make_start, render
from bench.blenderbench.task_set import read_set
from bench.sweep import command
from simworlds.cli import main

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.blenderbench.task_scenes import EditRenderSettings
    from bench.blenderbench.task_set import BenchTask, TaskSet

pytestmark = pytest.mark.blender


def loss(first: Path, second: Path) -> float:
    return photometric_loss(read_picture(first), read_picture(second))


def record_of(out: Path, task: str) -> TaskRecord:
    return read(task_folder(out, task).record, TaskRecord)


def task_of(found: TaskSet, name: str) -> BenchTask:
    return next(task for task in found.tasks if task.id == name)


def bench(*words: object) -> Any:
    return CliRunner().invoke(main, ["bench", "blenderbench", *map(str, words)])


# The baseline, and the trap


def test_renders_every_start_scene_through_the_sets_camera(unedited: Path, mini: TaskSet) -> None:
    for task in mini.tasks:
        record = record_of(unedited, task.id)
        assert (record.why, record.rounds) == (None, ("renders/01.png",))
        assert record.rendered is not None
        assert record.rendered.camera == "Camera1"
        assert record.start_loss == pytest.approx(0, abs=1e-3)  # this machine makes of it what the set's did
        assert loss(task_folder(unedited, task.id).root / "renders" / "01.png", task.goal) > 0.5


def test_start_py_replaces_the_goals_camera_of_a_raw_file(
    unedited: Path, mini: TaskSet, rendering: EditRenderSettings, tmp_path: Path
) -> None:
    task = task_of(mini, "level1/table1")
    untouched = task.code.replace("camera.location =", "ignored =").replace(
        "camera.rotation_euler", "ignored"
    )
    trapped = dataclasses.replace(task, code=untouched)
    run(mini, [trapped], UneditedStart(rendering), tmp_path / "trapped")
    raw = tmp_path / "trapped" / "level1" / "table1" / "renders" / "01.png"
    assert loss(raw, task.goal) == pytest.approx(0, abs=1e-3)
    assert loss(task_folder(unedited, task.id).root / "renders" / "01.png", task.goal) > 1


def test_the_start_scene_is_complete_and_has_no_goal_beside_it(
    unedited: Path, mini: TaskSet, rendering: EditRenderSettings, tmp_path: Path
) -> None:
    place = task_folder(unedited, "level2/mug1")
    assert [path.name for path in place.start.parent.iterdir()] == ["start.blend"]
    assert not [path for path in unedited.rglob("*") if path.suffix == ".py"]
    alone = tmp_path / "alone.blend"
    shutil.copy(place.start, alone)
    made = render(alone, tmp_path / "again.png", (48, 32), rendering)
    assert (made.camera, made.samples) == ("Camera1", 4)
    assert loss(tmp_path / "again.png", place.start_picture) == 0


FALLING = """\
import bpy

scene = bpy.context.scene
bpy.ops.rigidbody.world_add()
bpy.context.view_layer.objects.active = mug = bpy.data.objects["Mug"]
bpy.ops.rigidbody.object_add()
mug.location.z = 1
scene.frame_set({frame})
"""


def test_plays_unbaked_motion_up_to_the_frame(
    mini: TaskSet, rendering: EditRenderSettings, tmp_path: Path
) -> None:
    task = task_of(mini, "level1/table1")
    pictures = [tmp_path / "1.png", tmp_path / "10.png"]
    for frame, picture in zip((1, 10), pictures, strict=True):
        (tmp_path / str(frame)).mkdir()
        blend = tmp_path / str(frame) / "start.blend"
        falling = dataclasses.replace(task, code=task.code + FALLING.format(frame=frame))
        assert make_start(falling, blend, rendering) == ()
        render(blend, picture, (48, 32), rendering)
    assert loss(*pictures) > 0.2


def test_names_a_file_that_cannot_be_packed(
    mini: TaskSet, rendering: EditRenderSettings, tmp_path: Path
) -> None:
    task = task_of(mini, "level1/table1")
    code = "import bpy\nbpy.data.images['Label'].filepath = '//elsewhere.png'\n"
    (tmp_path / "kept").mkdir()
    notes = make_start(
        dataclasses.replace(task, code=task.code + code), tmp_path / "kept" / "start.blend", rendering
    )
    assert len(notes) == 1
    assert notes[0].startswith("not in the scene to be edited: file /")
    assert notes[0].endswith("elsewhere.png")


def test_records_have_provenance(unedited: Path, mini: TaskSet) -> None:
    record = record_of(unedited, "level1/table1")
    assert sorted(record.inputs) == ["blender_file.blend", "renders/goal/render1.png", "start.py", "task.txt"]
    assert len(record.provenance.code) == 64
    assert read_run(unedited).setup.settings == {"samples": 4}
    assert read_run(unedited).tasks == tuple(task.id for task in mini.tasks)


# Code and files of strangers


@pytest.fixture(scope="module")
def one(mini: TaskSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A set of one task, to be spoilt."""
    root = tmp_path_factory.mktemp("one")
    shutil.copytree(mini.root / "level1" / "table1", root / "level1" / "table1")
    return root


BAD_CODE = {
    "fails": ("import bpy\nbpy.data.objects['Nobody'].location = 1\n", "start.py fails, line 2: KeyError"),
    "quits": ("import os\nos._exit(0)\n", "ended from inside"),
    "no camera": ("import bpy\nbpy.data.objects.remove(bpy.data.objects['Camera1'])\n"
                  "bpy.data.objects.remove(bpy.data.objects['Overview'])\n", "no camera"),
    **({"no python": ("def (:\n", "start.py fails, line 1: SyntaxError")} if IS_WHOLE else {}),
}  # fmt: skip


def test_a_failed_task_says_why_and_others_go_on(
    one: Path, rendering: EditRenderSettings, tmp_path: Path
) -> None:
    for number, (code, _) in enumerate(BAD_CODE.values(), 2):
        shutil.copytree(one / "level1" / "table1", tmp_path / "set" / "level1" / f"table{number}")
        (tmp_path / "set" / "level1" / f"table{number}" / "start.py").write_text(code)
    found = read_set(tmp_path / "set")
    records = run(found, found.tasks, UneditedStart(rendering), tmp_path / "out")
    for record, (_, told) in zip(records, BAD_CODE.values(), strict=True):
        assert told in (record.why or ""), record.why
        assert record.rounds == ()
    assert not list((tmp_path / "out").rglob(".blender-*"))
    assert bench("score", tmp_path / "out").exit_code == 1


def test_start_py_cannot_write_or_read_outside_the_sandbox(
    one: Path, rendering: EditRenderSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Held by the sandbox where agents build; here it is shown to be used."""
    root = tmp_path / "set"
    shutil.copytree(one, root)
    target, secret = tmp_path / "escaped", tmp_path / "secret"
    secret.write_text("hidden")
    monkeypatch.setenv("ANTHROPIC_API_KEY", "key")
    (root / "level1" / "table1" / "start.py").write_text(
        f"import os\nassert 'ANTHROPIC_API_KEY' not in os.environ\n"
        f"for use in (lambda: open({str(target)!r}, 'w'), lambda: open({str(secret)!r})):\n"
        "    try:\n        use()\n    except OSError:\n        continue\n    raise SystemExit('it got out')\n"
    )
    found = read_set(root)
    [record] = run(found, found.tasks, UneditedStart(rendering), tmp_path / "out")
    assert record.why is None, record.why
    assert not target.exists()


def test_ends_code_that_takes_too_long(one: Path, rendering: EditRenderSettings, tmp_path: Path) -> None:
    shutil.copytree(one, tmp_path / "set")
    (tmp_path / "set" / "level1" / "table1" / "start.py").write_text("import time\ntime.sleep(600)\n")
    found = read_set(tmp_path / "set")
    [record] = run(
        found, found.tasks, UneditedStart(dataclasses.replace(rendering, seconds=4)), tmp_path / "out"
    )
    assert "The task's start.py ran past its deadline of 4 s" in (record.why or "")


# Renders made by anybody


def picture(path: Path, shade: int) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.new("RGB", (48, 32), (shade, shade, shade)).save(path)
    return path


def test_copies_rounds_in_natural_order(mini: TaskSet, tmp_path: Path) -> None:
    theirs = tmp_path / "theirs"
    for number in (1, 2, 10):
        picture(theirs / "level1" / "table1" / f"round{number}.png", number)
        picture(theirs / "level2" / "mug1" / "renders" / str(number) / "render1.png", 100 + number)
    records = run(mini, mini.tasks, RendersFolder(theirs), tmp_path / "out")
    told = {record.task: record for record in records}
    for task, shades in (("level1/table1", (1, 2, 10)), ("level2/mug1", (101, 102, 110))):
        assert told[task].rounds == ("renders/01.png", "renders/02.png", "renders/03.png")
        root = task_folder(tmp_path / "out", task).root
        assert tuple(read_picture(root / file).getpixel((0, 0))[0] for file in told[task].rounds) == shades  # type: ignore[index]
    assert "has no render" in (told["level3/mug1"].why or "")
    assert told["level1/table1"].cost is None


def test_rejects_links_out_of_the_folder_and_files_that_are_not_pictures(
    mini: TaskSet, tmp_path: Path
) -> None:
    theirs = tmp_path / "theirs"
    picture(tmp_path / "elsewhere.png", 1)
    (theirs / "level1" / "table1").mkdir(parents=True)
    (theirs / "level1" / "table1" / "1.png").symlink_to(tmp_path / "elsewhere.png")
    (theirs / "level1" / "table2").mkdir()
    (theirs / "level1" / "table2" / "1.png").write_bytes(b"no picture")
    records = run(mini, mini.tasks[:2], RendersFolder(theirs), tmp_path / "out")
    assert "is a link out of" in (records[0].why or "")
    assert "is not a PNG" in (records[1].why or "")


def test_copies_added_renders_when_run_again(mini: TaskSet, tmp_path: Path) -> None:
    theirs, out = tmp_path / "theirs", tmp_path / "out"
    picture(theirs / "level1" / "table1" / "1.png", 1)
    first = run(mini, mini.tasks[:2], RendersFolder(theirs), out)
    picture(theirs / "level1" / "table2" / "1.png", 2)
    picture(theirs / "level1" / "table1" / "2.png", 3)
    second = run(mini, mini.tasks[:2], RendersFolder(theirs), out)
    assert [len(record.rounds) for record in first] == [1, 0]
    assert [len(record.rounds) for record in second] == [2, 1]


def test_rejects_results_of_a_task_that_has_changed(one: Path, tmp_path: Path) -> None:
    root, theirs = tmp_path / "set", tmp_path / "theirs"
    shutil.copytree(one, root)
    picture(theirs / "level1" / "table1" / "1.png", 1)
    found = read_set(root)
    run(found, found.tasks, RendersFolder(theirs), tmp_path / "out")
    (root / "level1" / "table1" / "task.txt").write_text("Something else.")
    with pytest.raises(BadResults, match="has changed since"):
        run(found, found.tasks, RendersFolder(theirs), tmp_path / "out")


def test_rejects_a_folder_with_results_of_another_setup(
    mini: TaskSet, rendering: EditRenderSettings, tmp_path: Path
) -> None:
    theirs = tmp_path / "theirs"
    picture(theirs / "level1" / "table1" / "1.png", 1)
    run(mini, mini.tasks[:1], RendersFolder(theirs), tmp_path / "out")
    with pytest.raises(BadResults, match=r"holds results of .*folder.*Choose another folder"):
        run(mini, mini.tasks[:1], UneditedStart(rendering), tmp_path / "out")
    with pytest.raises(BadResults, match="is not empty and has no results"):
        run(mini, mini.tasks[:1], RendersFolder(theirs), theirs)


@pytest.mark.parametrize(
    ("folder", "name"), [("_viga 2", "viga 2"), ("rendus été", "rendus -t-"), ("результат", "folder")]
)
def test_a_folders_name_is_made_fit_for_tables(folder: str, name: str, tmp_path: Path) -> None:
    assert RendersFolder(tmp_path / folder).name == name


def test_rejects_a_name_that_tables_do_not_allow(mini: TaskSet, tmp_path: Path) -> None:
    words = ("--system", f"folder={tmp_path}", "--out", tmp_path / "out", "--name", "a|b\n")
    done = bench("run", mini.root, *words)
    assert done.exit_code == 2
    assert "cannot be a name in tables" in done.stderr


# SimWorlds itself, but for the model

MOVED = """\
import bpy
from mathutils import Vector

camera = bpy.data.objects["Camera1"]
camera.location = (1.6, -1.8, 1.3)
camera.rotation_euler = (Vector((0, 0, 0.2)) - camera.location).to_track_quat("-Z", "Y").to_euler()
"""
PLAN = {
    "title": "Another view",
    "tasks": [{"kind": "modify", "stage": "camera", "targets": ["Camera1"], "instruction": "As asked."}],
    "render": {"kind": "still", "engine": "CYCLES", "resolution": [48, 32], "samples": 1},
}


@pytest.fixture
def api(base: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeMessagesAPI]:
    """Answers for all roles: the camera goes to where the goal has it. What they are shown is small.

    There is a knowledge base, which would be built beside the edit otherwise.
    """
    monkeypatch.setattr(command, "simworlds_command", lambda: commands.SIMWORLDS)
    monkeypatch.setenv("PYTHONPATH", commands.PATH)
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "kb").symlink_to(base.parent)
    with FakeMessagesAPI(team.Team(plan=PLAN, code={"camera": MOVED})) as server:
        monkeypatch.setenv("ANTHROPIC_API_KEY", "any")
        monkeypatch.setenv("ANTHROPIC_BASE_URL", server.base_url)
        yield server


def test_edits_with_instruction_and_goal_and_scores_the_edited_scene(
    mini: TaskSet, api: FakeMessagesAPI, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    words = ("--system", "simworlds", "--task", "level1/table2", "--samples", 4, "--out", out)
    done = bench("run", mini.root, *words)
    assert done.exit_code == 0, done.output
    task, place = task_of(mini, "level1/table2"), task_folder(out, "level1/table2")
    assert loss(place.root / "renders" / "01.png", task_of(mini, "level1/table1").goal) < 0.01
    asked = api.received("POST /v1/messages")[0].body
    assert task.instruction in team.words_of(asked)  # though it begins like an option
    pictures = [block for block in asked["messages"][0]["content"] if block["type"] == "image"]
    assert len(pictures) >= 2
    record = record_of(out, "level1/table2")
    assert record.models["coder"].startswith("claude-")
    assert record.cost is not None
    assert record.cost > 0
    assert record.notes == ()

    place.record.unlink()  # as if it had been killed before it was written
    requests = len(api.received("POST /v1/messages"))
    assert bench("run", mini.root, *words).exit_code == 0
    assert record_of(out, "level1/table2").rounds == ("renders/01.png",)
    assert len(api.received("POST /v1/messages")) == requests


def test_without_a_key_nothing_starts(mini: TaskSet, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = bench(
        "run", mini.root, "--system", "simworlds", "--task", "level1/table1", "--samples", 1, "--out", out
    )
    assert done.exit_code == 2
    assert "needs a key: set ANTHROPIC_API_KEY" in done.stderr
    assert not task_folder(out, "level1/table1").start.exists()


# Kills


def test_a_killed_run_goes_on_where_it_was(mini: TaskSet, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["bench", "blenderbench", "run", str(mini.root), "--system", "start", "--samples", "4"]
    words += ["--task", "level1", "--out", str(out)]
    killed = subprocess.Popen(
        [sys.executable, "-m", "simworlds", *words],
        cwd=REPO,
        stderr=subprocess.PIPE,
        text=True,
        stdout=subprocess.DEVNULL,
    )
    assert killed.stderr is not None
    with killed.stderr as said:
        assert any("level1/table2: running start.py" in line for line in said)
        killed.send_signal(signal.SIGKILL)
    assert killed.wait() == -signal.SIGKILL
    kept = task_folder(out, "level1/table1").record.read_bytes()
    assert not task_folder(out, "level1/table2").record.exists()
    assert bench(*words[2:]).exit_code == 0
    assert task_folder(out, "level1/table1").record.read_bytes() == kept
    assert record_of(out, "level1/table2").why is None
    assert not list(out.rglob(".blender-*"))


# The command


@pytest.mark.parametrize(
    ("system", "told"),
    [("blender", "There is no system 'blender'"), ("folder=/nowhere", "is not a folder of renders")],
)
def test_rejects_an_unknown_system(system: str, told: str, mini: TaskSet, tmp_path: Path) -> None:
    done = bench("run", mini.root, "--system", system, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert told in done.stderr
    assert not (tmp_path / "out").exists()


def test_names_an_invalid_record(mini: TaskSet, tmp_path: Path) -> None:
    theirs, out = tmp_path / "theirs", tmp_path / "out"
    picture(theirs / "level1" / "table1" / "1.png", 1)
    run(mini, mini.tasks[:1], RendersFolder(theirs), out)
    path = task_folder(out, "level1/table1").record
    for spoilt in (b"{", json.dumps({**json.loads(path.read_bytes()), "rounds": ["../../x.png"]}).encode()):
        path.write_bytes(spoilt)
        done = bench("score", out)
        assert done.exit_code == 2
        assert str(path) in done.stderr


# The whole way, with a tower of CLIP's architecture


def test_scores_a_set_from_raw_files_to_the_table(unedited: Path, mini: TaskSet, tmp_path: Path) -> None:
    safetensors = pytest.importorskip("safetensors.numpy")
    safetensors.save_file(clip_sample.weights(), tmp_path / "model.safetensors")
    out = tmp_path / "out"
    shutil.copytree(unedited, out)
    for name in ("level1/table2", "level2", "level3"):
        shutil.rmtree(out / name)
    done = bench("score", out, "--clip", tmp_path)
    assert done.exit_code == 0, done.output
    task = mini.tasks[0]
    render, goal = (read_picture(path) for path in (out / task.id / "renders" / "01.png", task.goal))
    kept = read(task_folder(out, task.id).scores, Score)
    assert kept.pl == pytest.approx(photometric_loss(render, goal))
    assert kept.n_clip == pytest.approx(clip_distance(Tower(clip_sample.weights()), render, goal), abs=1e-3)
    assert kept.n_clip > 0
    text = bench("report", out, "--paper").stdout
    assert "unedited: 1 of 4 tasks" in text
    assert "differ from the set's own renders by PL 0.00" in text
