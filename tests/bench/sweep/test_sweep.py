"""A sweep over files that somebody made: scored, framed, and done again only where something changed."""

from __future__ import annotations

import json
import multiprocessing
import shutil
import signal
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from processes_below import all_end, below
from sweeping import CHEAP, SCENES, content, record, scores, written

from bench.audit.untrusted_blend import BlenderOptions
from bench.frames.clip_frames import RenderQuality
from bench.sweep.executor import LocalExecutor
from bench.sweep.records import SystemInfo, read_record, write_record
from bench.sweep.scene_selection import select_scenes
from bench.sweep.sweep import ScoringOptions, make_tasks
from bench.sweep.systems.folder import FolderSystem
from simworlds.cli import main
from simworlds.folder_lock import locked

if TYPE_CHECKING:
    from collections.abc import Callable

    from click.testing import Result
    from sweeping import Command

    from bench.sweep.scene_task import SceneTask

pytestmark = pytest.mark.blender


def swept(made: Path, out: Path, *words: str) -> Result:
    given = [
        "bench",
        "run",
        "--system",
        f"folder={made}",
        "--out",
        str(out),
        "--name",
        "theirs",
        *CHEAP,
        *words,
    ]
    return CliRunner().invoke(main, given)


@pytest.fixture(scope="module")
def done(made: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a whole sweep. Never write to it."""
    out = tmp_path_factory.mktemp("results")
    result = swept(made, out, "--scenes", SCENES)
    assert result.exit_code == 0, result.output
    assert "5 scenes: 3 scored, 0 judged" in result.stdout
    assert "1 not scored: no file" in result.stdout
    return out / "theirs"


@pytest.fixture
def results(done: Path, tmp_path: Path) -> Path:
    """A copy of them."""
    shutil.copytree(done, tmp_path / "out" / "theirs")
    return tmp_path / "out" / "theirs"


# What is found


def test_every_record_has_scores_or_a_reason(done: Path) -> None:
    found = scores(done)
    assert found["cloth_D1_03"] == (None, None, "no file")
    assert found["rigid_D1_01"] == (None, None, "it is not a .blend file")
    for scene in ("cloth_D1_01", "cloth_D1_02", "static_D1_01"):
        audit = json.loads((done / scene / "audit.json").read_text())
        assert found[scene] == (audit["mpr"], audit["spr"], None)
        assert audit["mpr"] is not None


def test_a_record_has_provenance(done: Path) -> None:
    found = record(done, "cloth_D1_02")
    produced, audited, framed = found["produced"], found["audited"], found["framed"]
    assert (produced["models"], produced["cost"], produced["minutes"]) == ({"model": "a-model"}, 0.5, 3)
    assert produced["blend"]["path"] == "cloth_D1_02/anything.blend"
    assert framed["seed"] == 0
    for part in (produced, audited, framed):
        assert {"simworlds", "commit", "dirty", "code", "python", "packages"} <= part["provenance"].keys()
        assert part["seconds"] >= 0
    assert audited["provenance"]["blender"].startswith("5.")
    assert len(audited["spec"]) == 64


def test_takes_frames_from_videos_or_pictures_and_renders_others(done: Path) -> None:
    assert record(done, "static_D1_01")["framed"]["origin"] == "picture"
    framed = record(done, "cloth_D1_01")["framed"]
    assert framed["origin"] == "blend"
    assert [file["path"] for file in framed["frames"]] == [
        f"frames/{share:03}.png" for share in range(0, 101, 25)
    ]


# What is done again


def test_a_repeated_sweep_does_not_score_again(made: Path, results: Path) -> None:
    before = written(results)
    assert swept(made, results.parent, "--scenes", "cloth_D1_01,cloth_D1_02,static_D1_01").exit_code == 0
    assert written(results) == before


def test_rescores_only_the_scene_whose_file_changed(made: Path, results: Path, tmp_path: Path) -> None:
    folder = tmp_path / "changed"
    shutil.copytree(made, folder)
    shutil.copy(made / "cloth_D1_02" / "anything.blend", folder / "cloth_D1_01.blend")
    (folder / "cloth_D2_01.blend").touch()
    before = scores(results)
    info = read_record(results / "static_D1_01")
    assert info is not None
    stamps = written(results)
    swept(folder, results.parent, "--scenes", "cloth_D1_01,static_D1_01", "--frames", "none")
    assert scores(results)["cloth_D1_01"] != before["cloth_D1_01"]
    again = read_record(results / "static_D1_01")
    assert again is not None
    assert (again.audited, again.framed) == (info.audited, info.framed)
    assert written(results)["cloth_D1_02"] == stamps["cloth_D1_02"]


def test_rescoring_repairs_damage_and_runs_no_system(results: Path) -> None:
    whole = content(results)
    (results / "cloth_D1_01" / "audit.json").write_text("{}")
    (results / "cloth_D1_02" / "frames" / "050.png").unlink()
    done = CliRunner().invoke(main, ["bench", "rescore", str(results.parent), *CHEAP])
    assert done.exit_code == 0, done.output
    assert content(results) == whole


def test_keeps_scores_when_the_file_is_gone(results: Path) -> None:
    before = scores(results)
    for path in results.glob("*/record.json"):
        found = read_record(path.parent)
        assert found is not None
        info = found.system.model_copy(update={"settings": {"folder": "/nowhere"}})
        write_record(path.parent, found.model_copy(update={"system": info}))
    done = CliRunner().invoke(main, ["bench", "rescore", str(results), *CHEAP])
    assert done.exit_code == 0, done.output
    assert scores(results) == before


# However it ends


@pytest.mark.parametrize(
    ("number", "code"),
    [(signal.SIGKILL, -9), pytest.param(signal.SIGINT, 130, marks=pytest.mark.whole)],
)
def test_a_killed_sweep_leaves_whole_records_and_no_process_and_goes_on(
    number: signal.Signals, code: int, made: Path, done: Path, tmp_path: Path, command: Callable[..., Command]
) -> None:
    words = ("run", "--system", f"folder={made}", "--out", tmp_path, "--name", "theirs", "--jobs", "1")
    words += ("--frames", "none", *CHEAP, "--scenes", "cloth_D1_01,cloth_D1_02")
    sweep = command(*words)
    sweep.until("[1/2]")
    children = below(sweep.process.pid)
    sweep.kill(number)
    assert sweep.process.returncode == code
    first = read_record(tmp_path / "theirs" / "cloth_D1_01")
    assert first is not None
    assert children
    assert all_end(children)
    assert not list(tmp_path.glob("theirs/*/*.part"))
    assert CliRunner().invoke(main, ["bench", *map(str, words)]).exit_code == 0
    assert read_record(tmp_path / "theirs" / "cloth_D1_01") == first
    mine = content(tmp_path / "theirs")
    assert mine == {path: digest for path, digest in content(done).items() if path in mine}
    assert len(mine) == 2


def test_a_crash_costs_only_one_scene(made: Path, tmp_path: Path) -> None:
    how = ScoringOptions(BlenderOptions(), RenderQuality(), frames=False)
    system = FolderSystem(SystemInfo(name="theirs", kind="folder"), made)
    tasks = make_tasks(system, select_scenes(["cloth_D1_01", "cloth_D1_03"]), tmp_path, how)

    def kill(task: SceneTask | None, _: str) -> None:
        for process in multiprocessing.active_children():
            if task is tasks[0]:
                process.kill()

    killed, other = sorted(LocalExecutor(1).work(tasks, kill), key=lambda done: done.task.spec.id)
    assert (killed.record, killed.fault) == (None, "its process ended without a result (SIGKILL)")
    assert other.record is not None
    assert other.record == read_record(tmp_path / "theirs" / "cloth_D1_03")


def test_two_sweeps_cannot_use_one_folder(made: Path, tmp_path: Path) -> None:
    (tmp_path / "theirs").mkdir()
    with locked(tmp_path / "theirs"):
        second = swept(made, tmp_path, "--scenes", "cloth_D1_03")
    assert (second.exit_code, "in use by another" in second.stderr) == (2, True)
    assert not (tmp_path / "theirs" / "cloth_D1_03").exists()


# What cannot be begun


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--system", "viga"], "simworlds, replay, or folder=DIR"),
        (["--system", "folder=/nowhere"], "/nowhere is not a folder"),
        (["--system", f"folder={Path(__file__).parent}"], "has no file or folder of any scene"),
        (["--system", "simworlds", "--provider", "openai"], "set OPENAI_API_KEY"),
        (["--system", "replay", "--price", "1/2"], "--price means nothing with --system replay"),
        (["--system", "simworlds"], "set the environment variable ANTHROPIC_API_KEY"),
        (["--system", "replay", "--no-stages"], "--no-stages means nothing with --system replay"),
        (["--system", "replay", "--scenes", "cloth_D9"], "matches no scene"),
        (["--system", "replay", "--scenes", ","], "names no scene"),
        (["--system", "replay", "--name", "../up"], "is not a valid name"),
        (["--system", "replay", "--frame-size", "big"], "WIDTHxHEIGHT"),
    ],
)
def test_says_why_a_sweep_cannot_start(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN", "OPENAI_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)
    done = CliRunner().invoke(main, ["bench", "run", *words, "--out", str(tmp_path / "out")])
    assert (done.exit_code, said in done.stderr) == (2, True), done.stderr
    assert not (tmp_path / "out").exists()


def test_names_a_damaged_record_and_keeps_it(made: Path, results: Path) -> None:
    (results / "cloth_D1_01" / "record.json").write_text('{"format": 7}')
    done = swept(made, results.parent, "--scenes", "cloth_D1_01")
    assert done.exit_code == 2
    assert "cloth_D1_01/record.json is not a valid record" in done.stderr
    assert (results / "cloth_D1_01" / "record.json").read_text() == '{"format": 7}'
