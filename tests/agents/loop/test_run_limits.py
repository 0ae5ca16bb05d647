"""What a session may use, and how it is stopped; it can always be gone on with."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any

import crates
import pytest
from fake_messages_api import Reply
from PIL import Image
from processes import becomes, of_run
from run_sessions import MESSAGES, answered, go_on, scenes, seat, sit
from team import ABORT, DONE, Team, call, reply, run, texts, whose
from whole import IS_WHOLE

from agents.loop.errors import NoRun, Unusable
from agents.loop.leaving import LATEST
from agents.loop.options import RunLimits
from agents.loop.record.journal import NAME, read_rows
from simworlds.own_command import own_command

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from commands import Command
    from fake_messages_api import FakeMessagesAPI

pytestmark = pytest.mark.blender


def _short() -> Team:
    return Team(decisions={"modeling": (ABORT,)})


def test_a_limit_of_nothing_asks_nobody(api: FakeMessagesAPI, tmp_path: Path) -> None:
    played = sit(tmp_path / "run", seat(RunLimits(max_cost=0)))
    assert (played.ended.how, api.requests) == ("stopped", [])
    assert "The limit of $0.00 is reached" in played.ended.why


def test_no_call_is_made_beyond_the_limit_and_with_more_money_the_run_goes_on(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    team = _short()

    def dear(params: dict[str, Any]) -> Reply:
        given = team(params)
        return Reply(given.text, given.stop_reason, given.content, output_tokens=10_000)

    api.answer = dear
    first = sit(tmp_path / "run", seat(RunLimits(max_cost=1.5)))
    assert first.ended.how == "stopped"
    assert "The limit of $1.50 is reached" in first.ended.why
    spent = sum(row["turn"]["cost"] for row in first.of("model.answered"))
    assert 0.2 <= spent <= 1.5
    asked = len(api.requests)
    again = go_on(tmp_path / "run")  # by the command that was told: the limit holds
    assert (again.ended.how, len(api.requests)) == ("stopped", asked)
    assert f"${spent:.2f} are spent" in again.ended.why
    more = go_on(tmp_path / "run", seat(RunLimits(max_cost=20)))
    assert more.taken == [("modeling", "abort")]
    assert len(api.requests) == len(more.of("model.answered"))


@pytest.mark.parametrize(
    ("camera", "is_delivered"),
    [(crates.CODE["camera"], True), pytest.param("1 + 1", False, marks=pytest.mark.whole)],
)
def test_a_limit_leaves_the_newest_sound_scene_and_a_picture(
    api: FakeMessagesAPI, tmp_path: Path, camera: str, *, is_delivered: bool
) -> None:
    team = Team(coder={"camera": (run(camera), DONE), "light": (run(crates.CODE["light"]), DONE)})

    def dear(params: dict[str, Any]) -> Reply:
        given = team(params)
        last = whose(params) == ("coder", "camera") and given.stop_reason == "end_turn"
        return Reply(given.text, given.stop_reason, given.content, output_tokens=400_000 if last else 20)

    api.answer = dear
    root = tmp_path / "run"
    first = sit(root, seat(RunLimits(max_cost=5)))
    assert first.ended.how == "stopped"
    assert first.ended.file == root / "scene.blend"
    assert first.ended.shown == root / LATEST
    assert [row["type"] for row in first.rows if row["type"] == "stage.closed"] == ["stage.closed"]
    cameras, closed = scenes(tmp_path / "look", root / "scene.blend", root / "checkpoints" / "modeling.blend")
    assert (cameras != closed) == is_delivered
    with Image.open(root / LATEST) as picture:
        assert picture.width >= 64


def test_roles_have_models_of_their_own_and_are_told_the_minutes_that_are_left(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    api.answer = _short()
    named = {"model": "claude-sonnet-5-5", "models": {"planner": "claude-haiku-5-5"}}
    played = sit(tmp_path / "run", seat(RunLimits(max_minutes=60)), **named)
    assert {row["role"]: row["model"] for row in played.of("model.asked")} == {
        "planner": "claude-haiku-5-5",
        "coder": "claude-sonnet-5-5",
        "reviewer": "claude-sonnet-5-5",
    }
    asked = [text for request in api.received(MESSAGES) for text in texts(request.body)]
    assert any("About 58 minutes are left" in text for text in asked if text.startswith("The stage modeling"))


def test_what_was_seen_of_the_same_scene_is_not_made_again(api: FakeMessagesAPI, tmp_path: Path) -> None:
    seen = call("blender_scene_layout_preview", subjects=["Crate"])
    turns = (run(crates.CODE["modeling"]), seen, call("blender_verify"), seen, run("1 + 1"), seen, DONE)
    api.answer = Team(coder={"modeling": turns}, decisions={"modeling": (ABORT,)})
    played = sit(tmp_path / "run")
    shown = [row for row in played.of("tool.answered") if row["name"] == "blender_scene_layout_preview"]
    assert [row["seconds"] == 0 for row in shown] == [False, True, False, True]  # anew once code ran


def test_a_model_without_a_known_price_has_no_limit_that_could_be_kept(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    with pytest.raises(Unusable, match=r"No price is known for the model 'llama-of-mine'.* --price"):
        sit(tmp_path / "run", seat(RunLimits(max_cost=5)), model="llama-of-mine")
    assert not api.requests
    assert not (tmp_path / "run").exists()


def test_when_the_time_is_up_the_run_stops_at_the_next_safe_point(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    api.answer = _short()
    played = sit(tmp_path / "run", seat(RunLimits(max_minutes=1e-6)))
    assert (played.ended.how, api.requests) == ("stopped", [])
    assert "minutes is reached" in played.ended.why
    assert go_on(tmp_path / "run", seat(RunLimits(max_minutes=60))).taken == [("modeling", "abort")]


def test_a_stop_that_is_asked_for_lets_the_call_under_way_end(api: FakeMessagesAPI, tmp_path: Path) -> None:
    at = seat()

    def stop(row: Any) -> None:
        if row["type"] == "tool.called" and row["role"] == "coder":
            at.stop.event.set()

    at.watcher.on_row = stop  # type: ignore[attr-defined]
    played = sit(tmp_path / "run", at)
    assert (played.ended.how, played.ended.why) == ("stopped", "You asked the run to stop.")
    assert [row["type"] for row in played.rows[-3:]] == ["tool.called", "tool.answered", "run.ended"]
    assert not played.rows[-2]["failed"]


# It hangs until it is ended, but not when it is run again.
HANG = """
import os, time
if not os.path.exists("hung"):
    open("hung", "w").close()
    time.sleep(600)
"""


@pytest.mark.timeout(600)
def test_signals_stop_a_run_gently_then_at_once_and_it_can_be_gone_on_with(
    home: Path, command: Callable[..., Command], tmp_path: Path
) -> None:
    root = tmp_path / "run"
    at_work: list[Command] = []
    to_send = {("planner", ""): signal.SIGTERM}
    if IS_WHOLE:
        to_send["coder", "modeling"] = signal.SIGINT

    def first(role: str, stage: str, params: dict[str, Any]) -> Reply | None:
        """A signal for who asks: while the planner thinks, then while the coder does."""
        if number := to_send.pop((role, stage), None):
            at_work[-1].send(number)
            at_work[-1].until("Stopping at the next safe point")
        return None

    team = Team(
        coder={"modeling": (run(HANG, timeout=500), run(crates.STANDING), reply(DONE))},
        decisions={"modeling": (ABORT,)},
        first=first,
    )
    with answered(home, team) as api:
        at_work.append(command("make", "A crate", "--run", root, url=api.base_url))
        code, _, err = at_work[-1].end()
        assert code == 3, err
        assert "Stopped: You asked the run to stop." in err
        assert f"Continue with: {own_command()} resume {root}" in err
        assert [row["type"] for row in read_rows(root / NAME)][-2:] == ["stage.began", "run.ended"]

        if IS_WHOLE:
            at_work.append(command("resume", root, url=api.base_url))
            code, _, err = at_work[-1].end()
            assert code == 3, err
            assert [row["type"] for row in read_rows(root / NAME)][-2:] == ["model.answered", "run.ended"]
            requests = len(api.requests)  # what the coder answered is not asked for again
        else:
            requests = len(api.requests) + 2  # the planner's tactic, and the coder's first turn

        last = command("resume", root, url=api.base_url)
        hangs = {"type": "tool.called", "role": "coder"}
        assert becomes(lambda: hangs.items() <= read_rows(root / NAME)[-1].items(), 120)
        with pytest.raises(NoRun, match="in use by another"):
            go_on(root)
        # The call is journalled before its code runs, and code that did not run yet would hang the next time.
        assert becomes(lambda: any((root / "blender").rglob("hung")), 120)
        last.send(signal.SIGINT)
        last.until("Stopping at the next safe point")
        last.send(signal.SIGINT)
        code, _, err = last.end()
        assert code == 3, err
        assert "Traceback" not in err
        assert read_rows(root / NAME)[-1]["outcome"] == "stopped"
        assert becomes(lambda: not of_run(root / "blender"))
        assert len(api.requests) == requests

        played = go_on(root)
        assert played.taken == [("modeling", "abort")]
        assert len(api.requests) == len(played.of("model.answered"))
