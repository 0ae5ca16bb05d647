"""A run that is played again from its record: without a key, without a server, and never taken for a live one."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING, Any

import pytest
from run_sessions import at_home, go_on, scenes, seat, sit

from agents.loop.demos import replay_options
from agents.loop.errors import NoRun
from agents.loop.film import allotted_time
from agents.loop.options import RunLimits
from agents.loop.record.journal import NAME, read_rows
from agents.loop.running.run_tools import RunTools
from agents.loop.running.tool_client import ToolOutcome

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from run_sessions import Played

pytestmark = pytest.mark.blender


@pytest.fixture
def alone(home: Path) -> Iterator[None]:
    """Nobody answers."""
    with at_home(home):
        yield


@pytest.fixture(scope="module")
def replayed(home: Path, mended: Played, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """On a machine of more cores, within other limits."""
    with at_home(home), pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(allotted_time.SYSTEM), "cores", lambda _: 64)
        limits = seat(RunLimits(max_minutes=600, render_minutes=7))
        return sit(tmp_path_factory.mktemp("replayed") / "run", limits, **replay_options(mended.root))


def test_a_replay_makes_the_same_scene_on_any_machine(
    mended: Played, replayed: Played, tmp_path: Path
) -> None:
    assert replayed.ended.how == "done"
    assert replayed.taken == mended.taken
    first, second = scenes(tmp_path, mended.root / "scene.blend", replayed.root / "scene.blend")
    assert first == second
    assert (replayed.root / "plan.json").read_bytes() == (mended.root / "plan.json").read_bytes()


def test_a_replayed_answer_is_never_marked_live_and_costs_nothing_now(replayed: Played) -> None:
    assert replayed.rows[0]["source"].startswith("recorded: ")
    turns = [row["turn"] for row in replayed.of("model.answered")]
    assert turns
    assert not any(turn["live"] for turn in turns)


def test_a_replay_that_is_stopped_goes_on(mended: Played, alone: None, tmp_path: Path) -> None:
    at = seat()
    at.watcher.on_row = lambda row: at.stop.event.set() if row["type"] == "attempt.ended" else None  # type: ignore[attr-defined]
    options = replay_options(_until(mended, tmp_path / "record", "decided"))
    assert sit(tmp_path / "run", at, **options).ended.how == "stopped"
    played = go_on(tmp_path / "run")
    assert played.taken == [("modeling", "retry")]
    assert "The record has no further turn for the coder (modeling)" in played.ended.why


def _until(played: Played, folder: Path, kind: str) -> Path:
    """The record of a run up to the first row of a type."""
    rows = played.rows
    end = next(place for place, row in enumerate(rows) if row["type"] == kind)
    return _record(folder, rows[: end + 1])


def _record(folder: Path, rows: list[dict[str, Any]]) -> Path:
    folder.mkdir()
    (folder / NAME).write_text("".join(json.dumps(row) + "\n" for row in rows))
    return folder


def test_another_prompt_is_another_conversation(mended: Played, alone: None, tmp_path: Path) -> None:
    options = replay_options(mended.root) | {"prompt": "A barrel stands on a floor"}
    played = sit(tmp_path / "run", **options)
    assert played.ended.how == "failed"
    assert (
        "The conversation is not the recorded one: the planner, call 1, message 1 (user)" in played.ended.why
    )
    assert "-A crate stands on a floor" in played.ended.why
    assert "+A barrel stands on a floor" in played.ended.why


def test_where_blender_answers_otherwise_the_replay_says_so_and_stops(
    mended: Played, alone: None, tmp_path: Path
) -> None:
    rows = mended.rows
    turn = next(row["turn"] for row in rows if "0.2))" in json.dumps(row.get("turn")))
    (call,) = [block for block in turn["content"] if block["type"] == "tool_use"]
    call["input"]["code"] = call["input"]["code"].replace("0.2))", "0.9))")
    played = sit(tmp_path / "run", **replay_options(_record(tmp_path / "record", rows)))
    assert played.ended.how == "failed"
    assert "The conversation is not the recorded one: the " in played.ended.why
    assert not played.of("decided")


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda root: shutil.rmtree(root), "does not hold a record"),
        (lambda root: (root / NAME).write_text(""), "does not hold a record"),
        (lambda root: (root / NAME).write_text("nonsense\n{}\n"), "not a row of a journal"),
        (lambda root: (root / NAME).write_text('{"type": "run.began"}\n'), "does not hold a record"),
    ],
)
def test_what_is_no_record_is_told_before_anything_is_begun(
    tmp_path: Path, spoil: Callable[[Path], object], says: str
) -> None:
    root = _record(tmp_path / "record", [{"type": "plan"}])
    spoil(root)
    with pytest.raises(NoRun, match=says):
        replay_options(root)


def test_a_record_without_answers_ends_in_words(mended: Played, alone: None, tmp_path: Path) -> None:
    record = _record(tmp_path / "record", read_rows(mended.root / NAME)[:2])
    played = sit(tmp_path / "run", **replay_options(record))
    assert played.ended.how == "failed"
    assert "The record has no further turn for the planner" in played.ended.why


class _Called:
    """Stands for a run's journal, its Blender and its deadline: what tools were called with."""

    def __init__(self) -> None:
        self.names = ["blender_material_preview", "blender_bake"]
        self.calls: list[dict[str, Any]] = []
        self.attempt = 1

    def find(self, _event: object) -> None:
        """Nothing was answered before."""

    def note(self, _event: object) -> None: ...

    def check(self) -> None: ...

    def is_read_only(self, _name: str) -> bool:
        return True

    def call(self, _name: str, arguments: dict[str, Any], _asked: object) -> ToolOutcome:
        self.calls.append(arguments)
        return ToolOutcome(())


def test_a_replay_leaves_nothing_out_since_the_machine_is_busy() -> None:
    for has_time, seconds, timeout in ((False, None, None), (True, 600, 1600)):
        called: Any = _Called()
        tools = RunTools(called, called, called, called, called, has_time=has_time, _is_aligned=True)
        tools.use("coder", "texture", "blender_material_preview", {"show": "scene"})
        tools.use("coder", "texture", "blender_material_preview", {"show": "scene", "seconds": 20})
        tools.use("coder", "texture", "blender_bake", {})
        first, second, bake = called.calls
        assert (first.get("seconds"), first.get("timeout")) == (seconds, timeout)
        assert second["seconds"] == 20, "what was asked for is asked for again"
        assert bake.get("timeout", 0) <= 3600, "the tool takes no more"
