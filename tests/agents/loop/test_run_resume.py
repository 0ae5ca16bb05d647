"""Runs that are killed, spoilt or fought over, and taken up again."""

from __future__ import annotations

import errno
import json
import shlex
import shutil
from collections import Counter
from typing import TYPE_CHECKING, Any

import crates
import pytest
import teams
from killing import events, is_tried, killed_at_every_kind, kinds
from PIL import Image, ImageChops
from processes import becomes, of_run
from run_sessions import MESSAGES, answered, go_on, scenes, seat, sit
from team import ABORT, DONE, NEEDS_FIX, Team, call, run

from agents.loop.errors import NoRun, RunError
from agents.loop.record import journal as journal_module
from agents.loop.record.journal import NAME, read_rows
from simworlds.folder_lock import locked

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI
    from run_sessions import Played

pytestmark = pytest.mark.blender

WHOLE = crates.STANDING + crates.CAMERA + crates.LIGHT


def at_once() -> Team:
    """Builds everything in one stage, and mends it after the rendering."""
    return Team(coder={"light": (run(WHOLE), DONE), "render": (run(teams.HIGHER), DONE)}, final=(NEEDS_FIX,))


# Killed

VARYING = ("seconds", "checkpoint", "i", "t", "n", "pictures")  # a picture holds when it was rendered


def plain(rows: list[dict[str, Any]]) -> set[str]:
    """What the rows say of the run, without what no two sessions have in common."""
    told = (
        "plan",
        "tactic",
        "attempt.ended",
        "verified",
        "reviewed",
        "decided",
        "rolled.back",
        "stage.closed",
    )
    return {
        json.dumps({key: row[key] for key in row if key not in VARYING}, sort_keys=True)
        for row in rows
        if row["type"] in (*told, "rendered", "final.reviewed", "run.ended")
    }


@pytest.mark.timeout(900)
def test_run_killed_at_every_kind_of_event_ends_like_an_undisturbed_one(home: Path, tmp_path: Path) -> None:
    with answered(home, at_once()) as api:
        whole = sit(tmp_path / "whole", stages=False)
    assert whole.ended.how == "done"
    root = tmp_path / "killed" / "run"
    root.parent.mkdir()
    with answered(home, at_once()) as api:
        deaths = killed_at_every_kind(root, home, api.base_url, stages=False)
        requests = len(api.received(MESSAGES))
    rows = read_rows(root / NAME)
    found = Counter(events(rows))

    assert rows[-1]["outcome"] == "done"
    once = {event for event in found if event[0] not in ("sitting.began", "scene.restored")}
    assert once == {event for event in events(whole.rows) if event[0] != "sitting.began"}
    assert {kind for kind, _ in deaths} >= set(filter(is_tried, kinds(whole.rows)))
    assert not [event for event in once if found[event] > 1 and event[0] != "model.asked"]
    assert plain(rows) == plain(whole.rows)
    # Asked again is only what no answer was written down of.
    unheard = sum(kind[0] == "model.answered" and where == "before" for kind, where in deaths)
    assert requests == len([row for row in rows if row["type"] == "model.answered"]) + unheard
    first, second = scenes(tmp_path / "look", whole.root / "scene.blend", root / "scene.blend")
    assert first == second
    assert (root / "plan.json").read_bytes() == (whole.root / "plan.json").read_bytes()
    with Image.open(root / "still.png") as one, Image.open(whole.root / "still.png") as other:
        assert ImageChops.difference(one.convert("RGB"), other.convert("RGB")).getbbox() is None
    assert becomes(lambda: not of_run(root / "blender"))


def test_a_finished_run_is_not_begun_again(mended: Played, tmp_path: Path) -> None:
    root = shutil.copytree(mended.root, tmp_path / "run")
    before = (root / NAME).read_bytes()
    again = go_on(root)  # without a key
    assert again.ended.how == "done"
    assert (again.ended.file, again.ended.shown) == (root / "scene.blend", root / "still.png")
    assert (root / NAME).read_bytes() == before


def test_what_a_coder_saves_under_a_stages_name_never_takes_the_place_of_its_checkpoint(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    saving = (run(crates.CAMERA), call("blender_save", name="modeling", verify=False), DONE)
    api.answer = Team(coder={"camera": saving}, decisions={"camera": (ABORT,)})
    at = seat()

    def stop(row: Any) -> None:
        if (row["type"], row.get("stage")) == ("attempt.ended", "camera"):
            at.stop.event.set()

    at.watcher.on_row = stop  # type: ignore[attr-defined]
    root = tmp_path / "run"
    assert sit(root, at).ended.how == "stopped"
    assert go_on(root).ended.how == "aborted"
    (modeling,) = scenes(tmp_path / "look", root / "checkpoints" / "modeling.blend")
    assert "Object Planks" in modeling
    assert "Object Camera" not in modeling


# What is wrong with a folder


@pytest.fixture(scope="module")
def stopped(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that was stopped after its plan."""
    with answered(home, Team()):
        at = seat()
        at.watcher.on_row = lambda row: at.stop.event.set() if row["type"] == "plan" else None  # type: ignore[attr-defined]
        played = sit(tmp_path_factory.mktemp("stopped") / "run", at)
    assert (played.ended.how, played.ended.why) == ("stopped", "You asked the run to stop.")
    return played.root


@pytest.fixture
def copy(stopped: Path, tmp_path: Path) -> Path:
    """A copy of it, to be spoilt."""
    return shutil.copytree(stopped, tmp_path / "run")


def test_a_torn_last_line_is_cut_off(api: FakeMessagesAPI, copy: Path) -> None:
    api.answer = Team(decisions={"modeling": (ABORT,)})
    whole = len(read_rows(copy / NAME))
    with (copy / NAME).open("ab") as file:
        file.write(b'{"i": 99, "type": "tool.ans')
    played = go_on(copy)
    assert played.taken == [("modeling", "abort")]
    assert [row["i"] for row in played.rows] == list(range(1, len(played.rows) + 1))
    assert len(played.rows) > whole


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "does not say what the run is"),
        ("nonsense\n{}\n", "line 1: not a row of a journal"),
        ('{"type": "run.began"}\n[1, 2]\n{}\n', "line 2: not a row"),
        ('{"no": "type"}\n{"type": "plan"}\n', "line 1: not a row"),
        ('{"type": "run.began", "stage": []}\n{"type": "plan"}\n', "line 1: not a row"),
        ('{"type": "plan"}\n', "does not say what the run is"),
        ('{"type": "run.began"}\n', "does not say what the run is to do"),
        ('{"type": "run.began", "options": {"prompt": ""}}\n', "does not say what the run is to do"),
        ("\x00" * 40 + "\n{}\n", "line 1: not a row"),
    ],
)
def test_broken_journal_is_reported_and_left_alone(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / NAME).write_text(text)
    with pytest.raises(NoRun, match=says):
        go_on(tmp_path)
    assert (tmp_path / NAME).read_text() == text


def _changed(root: Path, kind: str, change: Callable[[dict[str, Any]], object]) -> None:
    rows = read_rows(root / NAME)
    change(next(row for row in rows if row["type"] == kind))
    (root / NAME).write_text("".join(json.dumps(row) + "\n" for row in rows))


@pytest.mark.parametrize(
    ("kind", "change", "says"),
    [
        ("model.answered", lambda row: row.pop("turn"), "is not part of a record"),
        pytest.param(
            "model.asked", lambda row: row.pop("n"), "is not part of a record", marks=pytest.mark.whole
        ),
        ("tool.answered", lambda row: row.pop("content"), "not a valid 'tool.answered' row"),
        pytest.param(
            "tool.answered",
            lambda row: row.update(content=[{"type": "text"}]),
            "not a valid 'tool.answered' row",
            marks=pytest.mark.whole,
        ),
    ],
)
def test_broken_rows_end_the_session_with_an_error(
    api: FakeMessagesAPI, copy: Path, kind: str, change: Callable[[dict[str, Any]], object], says: str
) -> None:
    _changed(copy, kind, change)
    played = go_on(copy)
    assert played.ended.how == "failed"
    assert says in played.ended.why
    assert not api.requests


def test_missing_picture_is_reported(api: FakeMessagesAPI, copy: Path) -> None:
    picture = {"type": "picture", "path": "pictures/0.png", "media_type": "image/png"}
    _changed(copy, "tool.answered", lambda row: row.update(content=[picture]))
    played = go_on(copy)
    assert played.ended.how == "failed"
    assert "pictures/0.png, a picture of an earlier answer, cannot be read" in played.ended.why


def test_folder_without_a_run_is_reported(tmp_path: Path) -> None:
    with pytest.raises(NoRun, match="is not a run"):
        go_on(tmp_path)
    with pytest.raises(NoRun, match="is not a run"):
        go_on(tmp_path / "nowhere")


def test_a_run_needs_a_folder_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(NoRun, match="is not empty"):
        sit(tmp_path)
    with pytest.raises(NoRun, match="cannot be used as the folder of a run"):
        sit(tmp_path / "notes.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_run_in_use_by_another_process_is_reported(copy: Path) -> None:
    before = (copy / NAME).read_bytes()
    with locked(copy), pytest.raises(NoRun, match="in use by another"):
        go_on(copy)
    assert (copy / NAME).read_bytes() == before


def test_deleted_folder_ends_the_session_with_an_error(api: FakeMessagesAPI, tmp_path: Path) -> None:
    root = tmp_path / "run"

    def vanish(row: Any) -> None:
        if row["type"] == "stage.began":
            shutil.rmtree(root)

    played = sit(root, seat(on_row=vanish))
    assert played.ended.how == "failed"
    assert len(api.requests) < 10


# Where the disk is full


@pytest.mark.parametrize("room", [pytest.param(9, marks=pytest.mark.whole), 23])
def test_run_resumes_after_a_full_disk(
    api: FakeMessagesAPI, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, room: int
) -> None:
    api.answer = Team(decisions={"modeling": (ABORT,)})
    left = [room]
    write = journal_module._write

    def full(file: Any, data: bytes) -> None:
        left[0] -= 1
        if left[0] < 0:
            file.write(data[:5])
            raise OSError(errno.ENOSPC, "No space left on device")
        write(file, data)

    with monkeypatch.context() as patch:
        patch.setattr(journal_module, "_write", full)
        with pytest.raises(RunError, match=r"No space left on device\. Make room, then resume the run"):
            sit(tmp_path / "run")
    assert len(read_rows(tmp_path / "run" / NAME)) == room
    asked = len(api.requests)
    played = go_on(tmp_path / "run")
    assert played.taken == [("modeling", "abort")]
    unheard = asked - len([row for row in played.rows[:room] if row["type"] == "model.answered"])
    assert len(api.requests) == len(played.of("model.answered")) + unheard


def test_the_command_that_continues_a_run_can_be_pasted(tmp_path: Path) -> None:
    run = tmp_path / "run dö"
    run.mkdir()
    (run / NAME).touch()
    with pytest.raises(NoRun, match="continue the run in it") as refused:
        sit(run)
    assert shlex.split(str(refused.value))[-2:] == ["resume", str(run)]
