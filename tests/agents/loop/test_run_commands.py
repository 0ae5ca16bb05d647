"""``simworlds make``, ``resume``, ``replay``, ``demo``, ``runs`` and ``show``: what they print, and how they end."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner, Result
from domino_run import dominoes
from run_sessions import answered, at_home
from running import run_here
from team import ABORT, Team

from agents.loop.demos import demo_options
from agents.loop.record.elsewhere import remembered, runs_elsewhere
from agents.loop.record.journal import NAME
from simworlds.cli import main
from simworlds.own_command import own_command
from simworlds.settings import HOME_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from commands import Command
    from run_sessions import Played

pytestmark = pytest.mark.blender


def said(*words: object) -> Result:
    """What a command says in this process."""
    result = CliRunner().invoke(main, [str(word) for word in words], env={"COLUMNS": "200"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def live(*words: object) -> tuple[int, str, str]:
    """(exit code, stdout, stderr) of a command in this process that works with a Blender."""
    done = run_here([str(word) for word in words], {**os.environ, "COLUMNS": "200"}, Path.cwd())
    return done.returncode, done.stdout.decode(), done.stderr.decode()


@pytest.fixture
def alone(home: Path) -> Iterator[None]:
    """Nobody answers."""
    with at_home(home):
        yield


def test_make_ends_with_a_scene_a_picture_and_a_report(
    home: Path, command: Callable[..., Command], tmp_path: Path
) -> None:
    root = tmp_path / "run"
    with answered(home, Team()) as api:
        code, out, err = command("make", "A crate stands on a floor", "--run", root, url=api.base_url).end()
    assert code == 0, err
    assert out.splitlines() == [str(root / name) for name in ("scene.blend", "still.png", "report.html")]
    assert "A crate stands on a floor" in (root / "report.html").read_text()
    assert "\x1b" not in err
    assert "Camera closed" in err


def test_a_stage_that_cannot_be_closed_is_exit_code_1(home: Path, tmp_path: Path) -> None:
    root = tmp_path / "run"
    with answered(home, Team(decisions={"modeling": (ABORT,)})):
        code, out, err = live("make", "A crate", "--run", root, "--quiet")
    assert code == 1, err
    assert "Aborted: The stage modeling could not be closed: This cannot be built." in err
    assert out.splitlines() == [str(root / "report.html")]


def test_without_a_key_make_fails_with_exit_code_2_and_says_what_to_do(alone: None, tmp_path: Path) -> None:
    result = said("make", "A crate", "--run", tmp_path / "run")
    assert result.exit_code == 2
    assert (
        "Error: There is no key for the model: set the environment variable ANTHROPIC_API_KEY."
        in result.stderr
    )
    assert "resume" not in result.output
    assert not (tmp_path / "run").exists()


def test_without_a_blender_no_run_is_made(alone: None, home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ANTHROPIC_API_KEY", "any")
    result = said("make", "A crate", "--blender-exe", "/bin/true")
    assert result.exit_code == 2
    assert "No Blender was found: /bin/true is not Blender" in result.stderr
    assert "resume" not in result.output
    assert not [*(home / "runs").glob("*")]


def test_where_no_folder_can_be_made_that_is_told(alone: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", "/proc/nothing")
    result = said("demo", "smoke")
    assert result.exit_code == 2
    assert (
        "No folder for a run can be made in /proc/nothing/runs: No such file or directory." in result.stderr
    )


def test_a_limit_that_is_reached_is_exit_code_3(home: Path, tmp_path: Path) -> None:
    root = tmp_path / "run"
    with answered(home, Team()) as api:
        words = ("--max-cost", 0, "--quiet")
        code, _, err = live("make", "A crate", "--run", root, *words)
        assert code == 3, err
        assert f"Continue with: {own_command()} resume {root}" in err
        assert live("resume", root, *words)[0] == 3
        assert not api.requests


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("make", ""), "PROMPT is empty: say what is to be made."),
        (("make", " "), "PROMPT is empty: say what is to be made."),
        (("make", "A crate", "--role-model", "painter=x"), "--role-model takes ROLE=NAME"),
        (("make", "A crate", "--max-cost", "-1"), "--max-cost"),
        (("make", "A crate", "--max-minutes", "0"), "--max-minutes"),
        (("demo", "no-such"), "There is no demo 'no-such'"),
        (("demo", "velvet", "--blender", "five"), "'five' is not a Blender version"),
        (("demo", "velvet", "--blender-exe", "/nowhere/blender"), "There is no Blender at /nowhere/blender."),
        (("resume", "/nowhere/at/all"), "is not a run"),
        (("replay", "/nowhere/at/all"), "does not hold a record"),
        (("show", "/nowhere/at/all"), "is not a run"),
        (("make", "A crate", "--run", "/proc/nothing"), "cannot be used as the folder of a run"),
        (
            ("demo", "edit", "--run", "/proc/nothing"),
            "folder /proc/nothing-input cannot be used: /proc/nothing-input: No such file",
        ),
    ],
)
def test_errors_are_shown_without_a_traceback(
    alone: None, words: tuple[str, ...], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ANTHROPIC_API_KEY", "any")
    result = said(*words)
    assert result.exit_code == 2
    assert says in " ".join(result.output.split())
    assert "Traceback" not in result.output


def test_demo_without_a_name_lists_the_demos(alone: None) -> None:
    result = said("demo")
    assert result.exit_code == 0
    assert "simworlds demo dominoes" in result.stdout
    assert "Each plays a transcript against a real Blender" in result.stdout


@pytest.mark.blender
def test_of_a_demos_file_to_edit_nothing_is_left_but_the_file(tmp_path: Path) -> None:
    made = tmp_path / "run-input.blend"
    demo_options("edit", made)
    assert list(tmp_path.iterdir()) == [made]


def test_resume_of_a_finished_run_says_where_its_result_is(
    mended: Played, tmp_path: Path, alone: None
) -> None:
    root = shutil.copytree(mended.root, tmp_path / "run")
    result = said("resume", root)
    assert result.exit_code == 0
    assert str(root / "scene.blend") in result.stdout


def test_show_tells_how_a_run_stands(mended: Played, alone: None) -> None:
    result = said("show", mended.root)
    assert result.exit_code == 0
    for words in ("A crate stands on a floor", "Modeling", "Light"):
        assert words in result.stdout


def test_show_writes_the_report_anew(mended: Played, tmp_path: Path, alone: None) -> None:
    root = shutil.copytree(mended.root, tmp_path / "run")
    (root / "report.html").unlink(missing_ok=True)
    result = said("show", root, "--report")
    assert result.exit_code == 0
    assert (root / "report.html").exists()


BROKEN = {
    "empty": "",
    "nonsense": "nonsense\nmore\n",
    "other-types": '{"type": "run.began", "prompt": 3, "models": [], "t": {}}\n',
    "no-type": '{"a": 1}\n{"type": "plan"}\n',
    "torn": '{"type": "run.began", "prompt": "A torn one", "mode": "make"}\n{"type": "tool.an',
}


def test_a_report_that_cannot_be_written_costs_no_outcome(
    mended: Played, tmp_path: Path, alone: None
) -> None:
    shutil.copytree(mended.root, tmp_path / "run")
    report = tmp_path / "run" / "report.html"
    report.unlink(missing_ok=True)
    report.mkdir()
    done = said("resume", tmp_path / "run")
    assert done.exit_code == 0, done.output
    assert str(tmp_path / "run" / "scene.blend") in done.stdout.splitlines()
    shown = said("show", tmp_path / "run", "--report")
    assert shown.exit_code == 2
    for result in (done, shown):
        assert f"{report} cannot be written" in result.stderr
        assert f"{own_command()} show {tmp_path / 'run'} --report" in result.stderr


def test_runs_lists_good_and_broken_runs(mended: Played, base: Path, tmp_path: Path) -> None:
    (tmp_path / "kb").symlink_to(base.parent)
    with at_home(tmp_path):
        assert said("runs").exit_code == 0
        shutil.copytree(mended.root, tmp_path / "runs" / "good")
        for name, text in BROKEN.items():
            (tmp_path / "runs" / name).mkdir()
            (tmp_path / "runs" / name / NAME).write_text(text)
        (tmp_path / "runs" / "no-run").mkdir()
        result = said("runs")
        assert result.exit_code == 0
        for name in ("good", *BROKEN):
            assert name in result.stdout
        assert "no-run" not in result.stdout
        assert "A crate on a floor" in result.stdout
        assert result.stdout.count("unreadable") == 2
        assert f"The runs are in {tmp_path / 'runs'}." in result.stdout


def test_runs_in_folders_of_their_users_choice_are_listed_until_these_are_gone(
    mended: Played, base: Path, tmp_path: Path
) -> None:
    (tmp_path / "kb").symlink_to(base.parent)
    run = shutil.copytree(mended.root, tmp_path / "my films" / "one")
    with at_home(tmp_path):
        assert said("resume", tmp_path / "nothing").exit_code != 0
        assert said("resume", run).exit_code == 0
        result = said("runs")
        assert result.exit_code == 0
        assert str(run) in result.stdout
        assert str(tmp_path / "nothing") not in result.stdout
        assert "There are no other runs in" in result.stdout
        narrow = CliRunner().invoke(main, ["runs"], env={"COLUMNS": "80"}).stdout
        assert re.search(r" done .* (\d{4}-\d\d-\d\d|\d\d:\d\d) *$", narrow, re.MULTILINE)
        shutil.rmtree(run)
        assert str(run) not in said("runs").stdout
        assert list((tmp_path / "runs-elsewhere").iterdir()) == []


def test_a_run_that_cannot_be_looked_at_hides_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path))
    kept = tmp_path / "kept"
    for place in (tmp_path / "runs-elsewhere", kept):
        place.mkdir()
    (kept / NAME).touch()
    (tmp_path / "runs-elsewhere" / "1").write_text(f"/{'x' * 300}")
    (tmp_path / "runs-elsewhere" / "2").write_text(str(kept))
    assert runs_elsewhere() == [kept]


def test_in_a_pipe_each_run_is_one_line_with_its_whole_path(tmp_path: Path) -> None:
    run = tmp_path / "a folder with a name that is longer than eighty columns are wide" / "and then one more"
    with at_home(tmp_path / "home"), remembered(run):
        run.mkdir(parents=True)
        (run / NAME).write_text("".join(f"{json.dumps(row)}\n" for row in dominoes().rows))
        piped = CliRunner().invoke(main, ["runs"], env={"COLUMNS": None}).stdout
        narrow = CliRunner().invoke(main, ["runs"], env={"COLUMNS": "80"}).stdout
    assert any(str(run) in line and " done " in line for line in piped.splitlines())
    assert str(run) not in narrow


def test_options_that_come_too_late_for_a_run_are_told(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text("".join(f"{json.dumps(row)}\n" for row in dominoes().rows))
    late = said("resume", tmp_path, "--render-minutes", "10", "--samples", "32").output
    assert "--render-minutes and --samples change nothing of it" in " ".join(late.split())
    assert "change nothing" not in said("resume", tmp_path).output


_REMEMBERS = """
import sys
from pathlib import Path
from agents.loop.record.elsewhere import remembered
for name in range(20):
    root = Path(sys.argv[1]) / f"{sys.argv[2]}-{name}"
    with remembered(root):
        root.mkdir()
        (root / "journal.jsonl").touch()
"""


def test_processes_that_begin_runs_at_the_same_time_are_all_listed(tmp_path: Path) -> None:
    begun = [
        subprocess.Popen(
            [sys.executable, "-c", _REMEMBERS, str(tmp_path), str(number)],
            env={**os.environ, HOME_VARIABLE: str(tmp_path / "home")},
        )
        for number in range(6)
    ]
    assert [process.wait() for process in begun] == [0] * 6
    with at_home(tmp_path / "home"):
        assert {root.name for root in runs_elsewhere()} == {f"{n}-{m}" for n in range(6) for m in range(20)}


def test_a_listed_name_is_taken_from_any_folder(
    mended: Played, base: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "kb").symlink_to(base.parent)
    run = shutil.copytree(mended.root, tmp_path / "runs" / "2026-11-23-064530-12")
    monkeypatch.chdir(base.parent)
    with at_home(tmp_path):
        narrow = CliRunner().invoke(main, ["runs"], env={"COLUMNS": "80"}).stdout
        assert run.name in narrow
        assert " done " in narrow
        shown = said("show", run.name)
        assert shown.exit_code == 0
        assert "A crate stands on a floor" in shown.stdout
        resumed = said("resume", run.name)
        assert resumed.exit_code == 0
        assert str(run / "scene.blend") in resumed.stdout
        other = said("show", "2026-11-23")
        assert other.exit_code == 2
        assert "'simworlds runs' lists the runs" in " ".join(other.output.split())


@pytest.mark.parametrize("name", BROKEN)
def test_show_of_a_broken_run_says_what_it_can(alone: None, tmp_path: Path, name: str) -> None:
    (tmp_path / NAME).write_text(BROKEN[name])
    for options in ((), ("--report",)):
        result = said("show", tmp_path, *options)
        assert result.exit_code in (0, 2)
        assert "Traceback" not in result.output
