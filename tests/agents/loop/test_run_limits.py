"""What a sitting may use, and how it is stopped; it can always be gone on with."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any

import crates
import pytest
from fake_messages_api import Reply
from processes import becomes, of_run
from sittings import answered, go_on, seat, sit
from team import ABORT, DONE, Team, reply, run

from agents.loop.errors import NoRun
from agents.loop.journal import NAME, read_rows
from agents.loop.options import Limits

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from commands import Command
    from fake_messages_api import FakeMessagesAPI

pytestmark = pytest.mark.blender


def _short() -> Team:
    return Team(decisions={"modeling": (ABORT,)})


def test_a_limit_of_nothing_asks_nobody(api: FakeMessagesAPI, tmp_path: Path) -> None:
    played = sit(tmp_path / "run", seat(Limits(max_cost=0)))
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
    first = sit(tmp_path / "run", seat(Limits(max_cost=1.5)))
    assert first.ended.how == "stopped"
    assert "The limit of $1.50 is reached" in first.ended.why
    spent = sum(row["turn"]["cost"] for row in first.of("model.answered"))
    assert 0.2 <= spent <= 1.5
    asked = len(api.requests)
    again = go_on(tmp_path / "run", seat(Limits(max_cost=1.5)))
    assert (again.ended.how, len(api.requests)) == ("stopped", asked)
    assert f"${spent:.2f} are spent" in again.ended.why
    more = go_on(tmp_path / "run", seat(Limits(max_cost=20)))
    assert more.taken == [("modeling", "abort")]
    assert len(api.requests) == len(more.of("model.answered"))


def test_a_model_without_a_known_price_has_no_limit_that_could_be_kept(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    played = sit(tmp_path / "run", seat(Limits(max_cost=5)), model="llama-of-mine")
    assert (played.ended.how, api.requests) == ("stopped", [])
    assert "No price is known for the model 'llama-of-mine'" in played.ended.why


def test_roles_may_have_models_of_their_own(api: FakeMessagesAPI, tmp_path: Path) -> None:
    api.answer = _short()
    played = sit(tmp_path / "run", model="claude-sonnet-5-5", models={"planner": "claude-haiku-5-5"})
    models = {row["role"]: row["model"] for row in played.of("model.asked")}
    assert models == {
        "planner": "claude-haiku-5-5",
        "coder": "claude-sonnet-5-5",
        "reviewer": "claude-sonnet-5-5",
    }


def test_when_the_time_is_up_the_run_stops_at_the_next_safe_point(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    api.answer = _short()
    played = sit(tmp_path / "run", seat(Limits(max_minutes=1e-6)))
    assert (played.ended.how, api.requests) == ("stopped", [])
    assert "minutes is reached" in played.ended.why
    assert go_on(tmp_path / "run", seat(Limits(max_minutes=60))).taken == [("modeling", "abort")]


def test_a_stop_that_is_asked_for_lets_the_call_under_way_end(api: FakeMessagesAPI, tmp_path: Path) -> None:
    at = seat()

    def stop(row: Any) -> None:
        if row["type"] == "tool.called" and row["role"] == "coder":
            at.stop.event.set()

    at.watcher.on_row = stop  # type: ignore[attr-defined]
    played = sit(tmp_path / "run", at)
    assert (played.ended.how, played.ended.why) == ("stopped", "You asked it to stop.")
    assert [row["type"] for row in played.rows[-3:]] == ["tool.called", "tool.answered", "run.ended"]
    assert not played.rows[-2]["failed"]


HANG = "while True:\n    pass"


def test_signals_stop_a_run_gently_then_at_once_and_it_can_be_gone_on_with(
    home: Path, command: Callable[..., Command], tmp_path: Path
) -> None:
    root = tmp_path / "run"
    at_work: list[Command] = []
    to_send = [signal.SIGTERM, signal.SIGINT]

    def first(role: str, stage: str, params: dict[str, Any]) -> Reply | None:
        """A signal for who asks: while the planner thinks, then while the coder does."""
        if (role, stage, len(to_send)) in (("planner", "", 2), ("coder", "modeling", 1)):
            at_work[-1].send(to_send.pop(0))
            at_work[-1].until("Stopping at the next safe point")
        return None

    team = Team(
        coder={"modeling": (run(HANG, timeout=6), run(crates.STANDING), reply(DONE))},
        decisions={"modeling": (ABORT,)},
        first=first,
    )
    with answered(home, team) as api:
        at_work.append(command("make", "A crate", "--run", root, url=api.base_url))
        code, _, err = at_work[-1].end()
        assert code == 3, err
        assert "Stopped: You asked it to stop." in err
        assert f"Go on with: simworlds resume {root}" in err
        assert [row["type"] for row in read_rows(root / NAME)][-2:] == ["stage.began", "run.ended"]

        at_work.append(command("resume", root, url=api.base_url))
        code, _, err = at_work[-1].end()
        assert code == 3, err
        assert [row["type"] for row in read_rows(root / NAME)][-2:] == ["model.answered", "run.ended"]
        requests = len(api.requests)

        last = command("resume", root, url=api.base_url)
        hangs = {"type": "tool.called", "role": "coder"}
        assert becomes(lambda: hangs.items() <= read_rows(root / NAME)[-1].items(), 120)
        with pytest.raises(NoRun, match="in use by another"):
            go_on(root)
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
