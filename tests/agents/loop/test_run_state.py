"""A journal becomes a picture of its run, row by row, whatever is in it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from domino_run import dominoes, finding
from sample_runs import Tape, write

from agents.loop.record import events
from agents.loop.record.events import read_event
from agents.loop.record.reducer import after, read_run_state, run_state_after
from agents.loop.record.run_state import ModelCall, RunState, ToolCall
from agents.views.rich_views import run_row
from simworlds.llm.messages import Usage

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def rows() -> list[dict[str, Any]]:
    return dominoes().rows


@pytest.fixture(scope="module")
def whole(rows: list[dict[str, Any]]) -> RunState:
    return run_state_after(rows)


def test_stages_have_their_state_and_attempts(whole: RunState) -> None:
    found = {stage.name: (stage.state, len(stage.attempts)) for stage in whole.stages}
    assert found == {
        "modeling": ("closed", 2),
        "uv": ("skipped", 0),
        "texture": ("closed", 1),
        "deformation_setup": ("skipped", 0),
        "motion": ("closed", 2),
        "camera": ("closed", 1),
        "light": ("closed", 1),
        "render": ("closed", 1),
    }


def test_rejected_attempt_keeps_findings_review_and_decision(whole: RunState) -> None:
    stage = whole.stage("modeling")
    assert stage
    first, second = stage.attempts
    assert first.verification
    assert first.verification.hard == 13
    assert len(first.verification.findings) == 14
    assert first.review
    assert first.review.blocking
    assert first.choice
    assert (first.choice.taken, first.choice.overruled) == ("retry", False)
    assert first.choice.decision
    assert first.choice.decision.instructions == "Move every domino down by its gap."
    assert second.tactic is None, "a retry keeps its plan"
    assert second.choice
    assert (second.choice.taken, second.choice.decision) == ("advance", None)


def test_replan_has_its_own_plan_and_rollback(whole: RunState) -> None:
    stage = whole.stage("motion")
    assert stage
    first, second = stage.attempts
    assert first.rolled_back == "checkpoints/texture.blend"
    assert second.tactic
    assert second.tactic.goal.startswith("No keys")


def test_steps_keep_order_within_their_attempt(whole: RunState) -> None:
    stage = whole.stage("modeling")
    assert stage
    assert stage.attempts[0].tactic
    steps = [step for step in stage.attempts[0].steps if step.role == "coder"]
    told = [step.name if isinstance(step, ToolCall) else "says" for step in steps]
    assert told == [
        "blender_docs",
        "says",
        "blender_execute",
        "says",
        "blender_execute",
        "says",
        "blender_scene_layout_preview",
        "says",
    ]
    calls = list(stage.attempts[0].tools("coder"))
    assert [call.failed for call in calls] == [False, True, False, False]
    assert "primitive_domino_add" in calls[1].code
    assert calls[3].pictures[0].startswith("pictures/")
    assert all(call.is_answered for call in calls)
    assert not whole.pending


def test_costs_are_counted_by_role_and_stage(whole: RunState, rows: list[dict[str, Any]]) -> None:
    answers = [row["turn"] for row in rows if row["type"] == "model.answered"]
    assert whole.total.calls == len(answers)
    assert whole.total.cost == pytest.approx(sum(turn["cost"] for turn in answers))
    assert whole.total.usage.output == sum(turn["usage"]["output"] for turn in answers)
    by_key = {(row.role, row.stage): row for row in whole.spending}
    assert by_key["planner", ""].cost == pytest.approx(0.21)
    assert by_key["coder", "modeling"].calls == 6


def test_lost_tokens_are_counted() -> None:
    tape = Tape()
    tape.says("coder", "motion", "Hello")
    tape.rows[-1]["turn"]["lost"] = {"input": 5, "output": 7, "cache_read": 0, "cache_write": 0}
    tape.rows[-1]["turn"]["cost"] = None
    total = run_state_after(tape.rows).total
    assert total.usage == Usage(825, 417, 15_200, 1_300)
    assert total.unpriced == 1


def test_recorded_answers_cost_nothing() -> None:
    history = run_state_after(dominoes(live=False).rows)
    assert history.answers == "hand-written"
    assert history.total.cost == 0
    assert history.total.calls == 0
    assert history.total.recorded > 0


def test_a_run_that_is_live_only_in_part_is_called_mixed() -> None:
    tape = Tape(live=False)
    tape.says("coder", "motion", "recorded")
    tape.live = True
    tape.says("coder", "motion", "live")
    assert run_state_after(tape.rows).answers == "mixed"
    assert run_state_after(tape.rows[:2]).answers == "hand-written"
    assert run_state_after([]).answers == ""


def test_played_back_answers_of_a_model_are_recorded_ones() -> None:
    tape = Tape()
    tape.says("coder", "motion", "words")
    tape.rows[-1]["turn"]["live"] = False
    assert run_state_after(tape.rows).answers == "recorded"


def test_pause_between_sessions_is_not_counted_as_work(whole: RunState) -> None:
    assert whole.sessions == 2
    assert whole.began
    assert whole.latest
    assert (whole.latest - whole.began).total_seconds() - whole.seconds == pytest.approx(3600.0)
    motion = whole.stage("motion")
    assert motion
    assert motion.seconds < 600


def test_call_answered_in_the_next_session_is_one_call() -> None:
    tape = Tape()
    tape.began()
    tape.says("coder", "motion", "words")
    answered = tape.rows.pop()
    tape.pause(1000)
    tape.session()
    assert len(run_state_after(tape.rows).pending) == 1
    history = run_state_after([*tape.rows, answered])
    assert not history.pending
    calls = [step for step in history.all_steps() if isinstance(step, ModelCall)]
    assert len(calls) == 1
    assert calls[0].turn


def test_two_calls_at_a_time_get_their_own_answers() -> None:
    tape = Tape()
    tape.add("stage.began", stage="uv")
    tape.add("tool.called", n=1, role="reviewer", stage="uv", attempt=1, name="looks", input={})
    tape.add("tool.called", n=1, role="verifier", stage="uv", attempt=1, name="blender_verify", input={})
    for role in ("reviewer", "verifier"):
        content = [{"type": "text", "text": f"for the {role}"}]
        tape.add("tool.answered", n=1, role=role, stage="uv", attempt=1, name="x", content=content)
    stage = run_state_after(tape.rows).stage("uv")
    assert stage
    assert {step.role: step.texts for step in stage.attempts[0].tools()} == {
        "reviewer": ("for the reviewer",),
        "verifier": ("for the verifier",),
    }


def test_what_is_made_ready_before_the_plan_is_no_stage() -> None:
    tape = Tape()
    tape.began()
    tape.add("tool.called", n=1, role="runner", stage="modeling", name="blender_checkpoint", input={})
    tape.add("tool.answered", n=1, role="runner", stage="modeling", name="blender_checkpoint", content=[])
    tape.ended("failed", "There is no key.")
    state = run_state_after(tape.rows)
    assert (state.planning_state, state.state_of("modeling"), state.stages) == ("failed", "waiting", ())
    assert [step.is_answered for step in state.steps] == [True]


def test_a_stage_is_waiting_while_an_edits_file_is_judged_as_that_stage_will_be() -> None:
    tape = Tape()
    task = {"kind": "modify", "stage": "light", "targets": ["Key"], "instruction": "Dim it."}
    tape.add("plan", edit={"title": "Dimmer", "tasks": [task], "render": {"kind": "still"}})
    tape.add("tool.called", n=1, role="verifier", stage="light", name="blender_verify", input={})
    tape.add("tool.answered", n=1, role="verifier", stage="light", name="blender_verify", content=[])
    tape.ended("stopped", "")
    state = run_state_after(tape.rows)
    assert (state.state_of("light"), state.current) == ("waiting", None)
    tape.add("stage.began", stage="light")
    assert run_state_after(tape.rows[:-2] + tape.rows[-1:]).state_of("light") == "running"


def test_the_last_stage_runs_from_its_first_step_on_and_closes_with_the_run() -> None:
    tape = Tape()
    tape.began()
    tape.simple_stage("light")
    render = {"n": 1, "role": "runner", "stage": "render", "attempt": 1, "name": "blender_render"}
    tape.add("tool.called", **render, input={})
    assert run_state_after(tape.rows).state_of("render") == "running"
    tape.add("rendered", round=1, kind="still", path="still.png")
    tape.ended("done", "")
    assert run_state_after(tape.rows).state_of("render") == "closed"


def test_resumed_run_has_not_ended() -> None:
    tape = Tape()
    tape.began()
    tape.add("stage.began", stage="modeling")
    tape.ended("stopped", "The limit of $1.00 is reached.")
    stopped = run_state_after(tape.rows)
    assert stopped.outcome == "stopped"
    assert stopped.state_of("modeling") == "stopped"
    failed = after(stopped, read_event({"type": "run.ended", "outcome": "failed"}))
    assert failed.state_of("modeling") == "failed"
    tape.session()
    assert run_state_after(tape.rows).outcome == "unfinished"
    assert run_state_after(tape.rows).state_of("modeling") == "running"


def test_aborted_stage_leaves_closed_stages() -> None:
    tape = Tape()
    tape.began()
    tape.simple_stage("modeling")
    tape.add("stage.began", stage="uv")
    tape.add("attempt.began", stage="uv", attempt=1)
    tape.judged("uv", 1, "abort")
    tape.ended("aborted", "The stage uv could not be closed.")
    history = run_state_after(tape.rows)
    assert [history.state_of(name) for name in ("modeling", "uv", "texture")] == [
        "closed",
        "aborted",
        "waiting",
    ]


def test_the_share_of_stages_that_are_done_leaves_out_those_not_planned(rows: list[dict[str, Any]]) -> None:
    ends = [place for place, row in enumerate(rows) if row["type"] == "stage.closed"]
    shares = [run_state_after(rows[: end + 1]).share_done for end in ends]
    assert shares == pytest.approx([1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6])
    assert run_state_after(rows).share_done == 1
    assert run_state_after(rows[:3]).share_done == 0


def test_both_renders_have_their_review(whole: RunState) -> None:
    verdicts = [(one.round, one.review.verdict if one.review else "") for one in whole.renderings]
    assert verdicts == [(1, "needs_fix"), (2, "accept")]
    assert whole.renderings[1].path == "video.mp4"
    assert len(whole.renderings[1].pictures) == 5


def test_edit_lists_its_changes() -> None:
    tape = Tape()
    task = {"kind": "modify", "stage": "light", "targets": ["Key"], "instruction": "Dim it."}
    tape.add("plan", edit={"title": "Dimmer", "tasks": [task], "render": {"kind": "still"}})
    tape.add("edited", added=[], removed=[], changed=["Light Key", 7], unchanged=["Mesh Cube"], outside=[])
    history = run_state_after(tape.rows)
    assert history.title == "Dimmer"
    assert history.planned == ("light", "render")
    assert history.state_of("modeling") == "skipped"
    assert history.changes
    assert history.changes.changed == ("Light Key",)


# Whatever is in it


def test_reducing_row_by_row_gives_the_same_state(rows: list[dict[str, Any]], whole: RunState) -> None:
    history = RunState()
    for row in rows:
        before = history
        history = after(before, read_event(row))
        assert before.rows + 1 == history.rows, "the picture before is as it was"
    assert history == whole


def test_any_row_may_be_missing() -> None:
    tape = Tape()
    tape.began()
    tape.simple_stage("texture")
    rows = tape.rows
    for place in range(len(rows)):
        assert run_state_after(rows[:place] + rows[place + 1 :]).rows == len(rows) - 1


JUNK: tuple[Any, ...] = (
    None, True, -1, 1e308, float("nan"), 10**400, "", "\x1b[2J", "\ud800", [], [[]], [None], {},
    {"type": {}}, [{"path": 3}],
)  # fmt: skip


@pytest.mark.parametrize("junk", JUNK, ids=lambda junk: repr(junk)[:20])
def test_no_field_is_trusted(rows: list[dict[str, Any]], junk: Any) -> None:
    kinds: dict[str, dict[str, Any]] = {row["type"]: row for row in rows}
    before = run_state_after(rows[:60])
    for row in kinds.values():
        for name in row:
            if name != "type":
                assert run_state_after([row | {name: junk}, row], before).rows == 62


@pytest.mark.parametrize(
    "time", ["0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59-12:00", "noon", "2026-99-01"]
)
def test_invalid_times_are_ignored(time: str) -> None:
    tape = Tape()
    tape.began()
    history = run_state_after([{"type": "x", "t": time}, *tape.rows, {"type": "x", "t": time}])
    assert history.began == history.latest
    assert history.seconds == 0
    assert len(run_row("run", history)) == 6


def test_unknown_row_types_are_ignored(rows: list[dict[str, Any]], whole: RunState) -> None:
    others: list[dict[str, Any]] = [{"type": "scene.restored", "from": 3}, {"type": ["x"]}, {}]
    mixed = run_state_after([row for one in rows for row in (one, *others)])
    assert mixed.stages == whole.stages


def test_torn_last_line_is_ignored(tmp_path: Path, whole: RunState) -> None:
    path = write(dominoes(), tmp_path)
    with path.open("a") as file:
        file.write('{"i": 999, "type": "stage.beg')
    assert read_run_state(tmp_path) == whole


def test_a_folder_without_a_journal_is_an_empty_run(tmp_path: Path) -> None:
    assert read_run_state(tmp_path) == RunState()


def test_invalid_finding_is_ignored() -> None:
    tape = Tape()
    tape.add("stage.began", stage="uv")
    good = finding("V1", "A", "It floats.")
    tape.add("verified", stage="uv", attempt=1, ok=False, findings=[good, {"rule": 3}, "V2", None])
    stage = run_state_after(json.loads(json.dumps(tape.rows))).stage("uv")
    assert stage
    assert stage.last
    assert stage.last.verification
    assert [one.rule for one in stage.last.verification.findings] == ["V1"]
    assert stage.last.verification.hard == 1


# Rows and events


def test_every_row_survives_being_read_and_written(rows: list[dict[str, Any]]) -> None:
    for row in rows:
        event = read_event(row)
        written = json.loads(json.dumps(event.as_row()))
        assert written.keys() <= row.keys()
        assert read_event({**written, "i": row["i"], "t": row["t"]}) == event


def test_an_event_without_a_field_has_its_default() -> None:
    assert read_event({"type": "verified", "stage": "uv"}) == events.Verified(stage="uv")
    assert read_event({"type": "run.began", "models": 3}).as_row() == {"type": "run.began"}


def test_an_event_of_a_newer_type_keeps_what_it_is_about() -> None:
    event = read_event({"type": "stage.paused", "stage": "uv", "colour": "red"})
    assert (type(event), event.type, event.stage) == (events.Event, "stage.paused", "uv")
