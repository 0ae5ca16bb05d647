"""What a person sees while a run lasts: a drawing on a terminal, lines elsewhere, never a control character."""

from __future__ import annotations

import io
import os
import re
import threading
from typing import TYPE_CHECKING, Any

import pytest
from domino_run import domino_plan, dominoes, finding
from hostile_text import HOSTILE, steering
from sample_runs import Tape

from agents.loop.record.events import read_event
from agents.loop.record.reducer import after, run_state_after
from agents.loop.record.run_state import RunState
from agents.views.live_view import RunLog, RunScreen, RunView, make_view
from agents.views.now import Now, ToolProgress
from agents.views.rich_views import run_in_progress, run_row, run_summary, runs_table
from agents.views.time_left import describe_time_left, film_left, seconds_left
from simworlds.terminal.console import Console

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import RenderableType

EVIL = "\x1b[2J\x1b]0;owned\x07[red]\r\n\u202e\x9b31m"
_STEERING = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e]")


def drawn(what: RenderableType, width: int = 120) -> str:
    console = Console(io.StringIO(), width=width, height=40, color_system=None)
    console.print(what)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def until(kind: str, nth: int = 1) -> RunState:
    """The dominoes' run, up to the row of that type."""
    rows = dominoes().rows
    places = [place for place, row in enumerate(rows) if row["type"] == kind]
    return run_state_after(rows[: places[nth - 1] + 1])


def lines_of(tape: Tape) -> list[str]:
    stream = io.StringIO()
    with RunLog(stream) as view:
        for row in tape.rows:
            view.take(read_event(row))
    return stream.getvalue().splitlines()


# Lines


def test_what_could_not_be_decided_is_not_called_a_hard_finding() -> None:
    tape = Tape()
    tape.began()
    tape.add("stage.began", stage="motion")
    unsure = {**finding("V2", "Gust", "'Gust' could not be checked."), "outcome": "undecided"}
    tape.judged("motion", 1, "retry", (unsure,))
    told = "\n".join(lines_of(tape))
    assert "verifier: 1 hard rule undecided" in told
    assert "attempt 1 sent back: 1 hard rule undecided" in told
    many = tuple(
        finding(f"R{at}", "Gust", f"It is wrong by {name}.")
        for at, name in enumerate(("far", "much", "little", "half"))
    )
    tape.judged("motion", 2, "retry", (*many, unsure))
    told = "\n".join(lines_of(tape))
    assert "verifier: 4 hard findings, 1 hard rule undecided" in told
    assert "more kinds" in told
    tape.judged("motion", 3, "retry", many)
    assert "and 1 more kind\n" in "\n".join(lines_of(tape))


def test_log_lines_follow_the_run() -> None:
    told = "\n".join(lines_of(dominoes()))
    for words in (
        "00:00  make: Twelve wooden dominoes",
        "Plan: Twelve dominoes (15 objects, 39 relations)",
        "Modeling, attempt 1\n",
        "blender_execute failed, 2.0 s: AttributeError: no operator",
        "verifier: 12 hard findings, 1 hard rule undecided, 1 soft finding",
        "V1 ×12 Domino.01 … Domino.12 (12) · Table",
        "reviewer blocks: The row is even.",
        "attempt 1 sent back: 12 hard findings, 1 hard rule undecided, the reviewer blocks: The verifier measured it",
        "Modeling closed after 2 attempts, 1 min 14 s",
        "UV: skipped",
        "back to checkpoints/texture.blend",
        "Resumed, session 2.",
        "Final review: needs a fix: The last domino is cut off.",
        "Run done",
        "cost: $1.28",
    ):
        assert words in told
        told = told[told.index(words) :]


def test_a_line_says_that_answers_were_not_live() -> None:
    assert any("No model was asked in this run" in line for line in lines_of(dominoes(live=False)))
    assert not any("No model was asked" in line for line in lines_of(dominoes()))


def test_progress_is_told_now_and_then() -> None:
    now = [0.0]
    stream = io.StringIO()
    with RunLog(stream, clock=lambda: now[0]) as view:
        for second in range(31):
            now[0] = float(second)
            view.progress("blender_bake", second, 30, f"frame {second}")
    told = stream.getvalue().splitlines()
    assert [line.split("bake")[1] for line in told] == [" 33 % frame 10", " 67 % frame 20", " 100 % frame 30"]
    assert [line.split()[0] for line in told] == ["00:10", "00:20", "00:30"]


def test_log_and_screen_tell_that_a_model_is_asked_again() -> None:
    stream = io.StringIO()
    with RunLog(stream) as view:
        view.asking_again("final_reviewer", "529: overloaded; asking again in 4 s")
    assert (
        stream.getvalue() == "00:00    final reviewer has no answer: 529: overloaded; asking again in 4 s\n"
    )
    console = Console(io.StringIO(), width=100, height=40, force_terminal=True, color_system=None)
    with RunScreen(console) as screen:
        screen.take(read_event({"type": "model.asked", "role": "planner", "n": 1}))
        screen.saying("planner", "half an answ")
        screen.asking_again("planner", "the stream broke; asking again in 4 s")
        shown = drawn(screen.draw())
    assert "asking again in 4 s" in shown
    assert "half an answ" not in shown


def test_log_continues_a_resumed_run() -> None:
    stream = io.StringIO()
    with RunLog(stream, until("stage.closed")) as view:
        view.take(read_event({"type": "stage.began", "stage": "texture"}))
    assert stream.getvalue() == "01:35  Texture begins\n"


class _Gone(io.StringIO):
    def write(self, s: str, /) -> int:
        raise BrokenPipeError


def test_survives_a_closed_log_reader() -> None:
    with RunLog(_Gone()) as view:
        view.take(read_event(dominoes().rows[0]))


def test_letters_the_stream_cannot_encode_are_replaced() -> None:
    raw = io.BytesIO()
    with RunLog(io.TextIOWrapper(raw, "ascii", write_through=True)) as view:
        for row in dominoes().rows:
            view.take(read_event(row))
    assert b"Domino.01 ? Domino.12" in raw.getvalue()


# The drawing


def test_the_stages_stand_with_their_state() -> None:
    told = drawn(run_in_progress(until("attempt.began", 2), Now(70.0), 40))
    assert re.search(r"▶ +Modeling +attempt 2", told)
    assert re.search(r"– +UV +skipped", told)
    assert re.search(r"· +Texture +waiting", told)


def test_what_the_coder_does_now_is_shown_with_how_far_it_is() -> None:
    tape = dominoes()
    place = next(n for n, row in enumerate(tape.rows) if row.get("name") == "blender_bake")
    history = run_state_after(tape.rows[: place + 1])
    now = Now(history.seconds, {}, {"blender_bake": ToolProgress(48, 96, "frame 48 of 96")})
    told = drawn(run_in_progress(history, now, 40))
    assert "coder A rigid body world." in told
    assert re.search(r"coder blender_bake +━+ 50% +frame 48 of 96", told)


def test_streamed_words_are_shown_by_their_end() -> None:
    history = run_state_after([{"type": "model.asked", "n": 1, "role": "coder", "stage": "uv"}])
    told = drawn(
        run_in_progress(history, Now(3.0, {"coder": "beginning " + "and on " * 80 + "to the end"}), 40)
    )
    assert "to the end" in told
    assert "beginning" not in told


def test_findings_of_the_last_attempt_stay_until_the_next_is_judged() -> None:
    told = drawn(run_in_progress(until("attempt.began", 2), Now(70.0), 40))
    assert "Attempt 1: sent back: 12 hard findings, 1 hard rule undecided, the reviewer blocks" in told
    assert "V1 ×12 Domino.01 … Domino.12 (12) · Table" in told
    assert "Reviewer blocks: The row is even." in told


@pytest.mark.parametrize("height", [10, 24, 40])
def test_it_fits_a_terminal(height: int) -> None:
    for place in (40, 60, 95, 140):
        history = run_state_after(dominoes().rows[:place])
        told = drawn(
            run_in_progress(history, Now(history.seconds, folder="/a/long/folder"), height), width=80
        )
        assert len(told.splitlines()) <= max(height, 18)


def test_time_left_is_shown_once_enough_is_done() -> None:
    assert seconds_left(until("stage.began")) is None
    assert seconds_left(until("stage.closed", 1)) is None, "one of six stages tells little"
    two = until("stage.closed", 2)
    assert seconds_left(two) == pytest.approx((74.0 + 23.6) / 2 * 3, rel=0.02)
    assert "02:12 · about 2 min left, and at most 20 min for the film" in drawn(
        run_in_progress(two, Now(132.0), 40)
    )
    assert seconds_left(until("run.ended")) is None


def test_a_stage_that_takes_longer_than_the_others_does_not_use_up_their_time() -> None:
    under_way = until("stage.began", 3)
    each = (74.0 + 23.6) / 2
    assert seconds_left(under_way) == pytest.approx(3 * each, rel=0.02)
    assert seconds_left(under_way, since=1e9) == pytest.approx(2.2 * each, rel=0.02)


def test_the_time_of_the_film_is_known_from_the_plan_on_and_follows_a_resume() -> None:
    planned = until("plan")
    assert describe_time_left(planned, Now(planned.seconds)) == "at most 20 min for the film"
    more = after(planned, read_event({"type": "sitting.began", "pid": 1, "render_minutes": 45.0}))
    assert describe_time_left(more, Now(more.seconds)) == "at most 45 min for the film"
    limited = after(planned, read_event({"type": "sitting.began", "pid": 1, "max_minutes": 85.0}))
    assert describe_time_left(limited, Now(limited.seconds)) == "", "what the limit leaves is not known yet"
    assert describe_time_left(until("run.ended"), Now(377.0)) == ""


def test_the_log_says_what_is_left_as_a_stage_closes() -> None:
    first, second, *_ = [line for line in lines_of(dominoes()) if " closed after " in line]
    assert first.endswith("(at most 20 min for the film)")
    assert second.endswith("(about 2 min left, and at most 20 min for the film)")


def test_costs_are_shown_and_recorded_answers_cost_nothing() -> None:
    assert "$1.28 · 554.2k in, 13.1k out" in drawn(run_in_progress(until("run.ended"), Now(377.0), 40))
    recorded = drawn(run_in_progress(run_state_after(dominoes(live=False).rows), Now(377.0), 40))
    assert "recorded answers, nothing to pay" in recorded
    assert "No model was asked" in recorded


def test_screen_shows_the_last_state_when_it_closes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")  # a dumb terminal has no cursor to hide
    console = Console(io.StringIO(), width=100, height=40, force_terminal=True, color_system=None)
    with RunScreen(console, "/tmp/run") as view:
        for row in dominoes().rows:
            view.take(read_event(row))
            view.saying("coder", "words")
            view.progress("blender_bake", 1, None, "")
    assert isinstance(console.file, io.StringIO)
    written = console.file.getvalue()
    last = written[written.rindex("Twelve dominoes  done") :]
    assert re.search(r"✓ +Render", last)
    assert written.rstrip().endswith("\x1b[?25h"), "the cursor is back"


def test_words_of_models_and_tools_cannot_steer_the_terminal() -> None:
    console = Console(io.StringIO(), width=200, height=40, force_terminal=True)
    with RunScreen(console, HOSTILE) as view:
        tape = Tape()
        tape.began(HOSTILE, models={"planner": HOSTILE})
        for row in tape.rows:
            view.take(read_event(row))
        view.saying("planner", HOSTILE)
        view.progress("blender_bake", 1, None, HOSTILE)
    assert isinstance(console.file, io.StringIO)
    assert "evil" in console.file.getvalue()
    assert steering(console.file.getvalue(), is_terminal=True) == []


def test_rows_words_and_progress_may_come_from_several_threads() -> None:
    console = Console(io.StringIO(), width=100, height=40, force_terminal=True, color_system=None)
    tapes = [Tape(), Tape(), Tape(), Tape()]
    with RunScreen(console) as view:

        def play(tape: Tape, role: str) -> None:
            for n in range(50):
                tape.says(role, "motion", f"words {n}")
                view.saying(role, "more ")
                view.progress("blender_bake", n, 50, "frame")
            for row in tape.rows:
                view.take(read_event(row))

        threads = [threading.Thread(target=play, args=(tape, f"role{n}")) for n, tape in enumerate(tapes)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert view.run_state.rows == sum(len(tape.rows) for tape in tapes)
    assert view.run_state.total.calls == 200
    assert not view.run_state.pending


@pytest.fixture
def terminal() -> Iterator[Any]:
    """The writing end of a real pseudo-terminal."""
    pty = pytest.importorskip("pty")
    leader, follower = pty.openpty()
    with os.fdopen(follower, "w") as stream:
        yield stream
    os.close(leader)


def test_a_terminal_gets_a_screen_and_a_pipe_gets_lines(
    terminal: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "xterm-256color")
    assert isinstance(make_view(terminal), RunScreen)
    assert isinstance(make_view(io.StringIO()), RunLog)
    monkeypatch.setenv("TERM", "dumb")
    assert isinstance(make_view(terminal), RunLog)


def test_quiet_view_keeps_the_state() -> None:
    with RunView() as view:
        for row in dominoes().rows:
            view.take(read_event(row))
        view.saying("coder", "words")
        view.progress("tool", 1, 2, "")
    assert view.run_state == run_state_after(dominoes().rows)


# Runs


def test_a_whole_run_is_shown_with_what_went_wrong_in_it() -> None:
    told = drawn(run_summary(until("run.ended")))
    assert (
        "Modeling, attempt 1: sent back: 12 hard findings, 1 hard rule undecided, the reviewer blocks" in told
    )
    assert "Motion, attempt 1: planned anew: 1 hard finding" in told
    assert "Final review 2: accepted. All fall." in told


def test_runs_are_listed_with_how_they_stand() -> None:
    stopped = Tape()
    stopped.began("A cloth falls over a table")
    stopped.add("stage.began", stage="motion")
    stopped.ended("stopped")
    table = runs_table(
        [("first", until("run.ended")), ("second", run_state_after(stopped.rows)), ("third", RunState())]
    )
    told = [re.split(r"  +", line.strip()) for line in drawn(table).splitlines() if line.strip()]
    assert told[0] == ["Run", "What", "Outcome", "Stage", "Cost", "When"]
    assert told[2][:4] == ["first", "Twelve dominoes", "done", "$1.28"]
    assert told[3][:4] == ["second", "A cloth falls over a table", "stopped", "Motion"]
    assert told[4][:2] == ["third", "unfinished"]


def test_the_day_of_a_run_stays_whole_in_a_narrow_terminal() -> None:
    tape = Tape()
    tape.began("Twelve wooden dominoes stand in a chain on a table")
    tape.add("stage.began", stage="deformation_setup")
    tape.ended("stopped")
    told = drawn(runs_table([("2026-11-29-120019", run_state_after(tape.rows))]), 80)
    assert re.search(r" \d{4}-\d\d-\d\d$", told, re.MULTILINE)


# Hostile words


def hostile() -> Tape:
    tape = Tape()
    tape.began(EVIL, mode=EVIL, source=EVIL)
    plan = domino_plan()
    plan["title"] = EVIL
    tape.add("plan", plan=plan)
    tape.add("stage.began", stage=EVIL)
    tape.add("attempt.began", stage=EVIL, attempt=1)
    tape.codes(EVIL, 1, EVIL, EVIL, EVIL, failed=True)
    tape.uses("coder", EVIL, 1, EVIL, {}, EVIL, failed=True)
    tape.add("attempt.ended", stage=EVIL, attempt=1, report=EVIL, ended=EVIL)
    tape.judged(EVIL, 1, "retry", (finding(EVIL, EVIL, EVIL, fix=EVIL),), instructions=EVIL)
    review = {"judgements": [], "blocking": True, "summary": EVIL}
    tape.add("reviewed", stage=EVIL, attempt=1, review=review)
    tape.add("rolled.back", stage=EVIL, attempt=1, to=EVIL)
    tape.add("edited", added=[], removed=[], changed=[EVIL], unchanged=[], outside=[EVIL])
    tape.add("tool.called", n=9, role=EVIL, stage=EVIL, attempt=1, name=EVIL, input={})
    tape.add("model.asked", n=9, role=EVIL, stage=EVIL)
    return tape


def test_control_characters_are_never_printed() -> None:
    tape = hostile()
    now = Now(1.0, {EVIL: EVIL, "coder": EVIL}, {EVIL: ToolProgress(float("nan"), 3, EVIL)}, EVIL)
    told = ["\n".join(lines_of(tape))]
    told += [
        drawn(run_in_progress(run_state_after(tape.rows), now, 40)),
        drawn(run_summary(run_state_after(tape.rows))),
    ]
    tape.ended(EVIL, EVIL)
    told += ["\n".join(lines_of(tape)), drawn(run_summary(run_state_after(tape.rows)))]
    told.append(drawn(runs_table([(EVIL, run_state_after(tape.rows))])))
    for text in told:
        assert not _STEERING.search(text), _STEERING.findall(text)
        assert "owned" in text, "what they say is shown, but does nothing"


def test_progress_of_any_numbers_is_drawn() -> None:
    call = {"type": "tool.called", "n": 1, "role": "coder", "stage": "uv", "name": "bake", "input": {}}
    history = run_state_after([call])
    for done, total in (
        (float("nan"), 3.0),
        (5.0, 3.0),
        (-1.0, 3.0),
        (1.0, 0.0),
        (float("inf"), 2.0),
        (1.0, None),
    ):
        assert "bake" in drawn(
            run_in_progress(history, Now(0.0, {}, {"bake": ToolProgress(done, total, "")}), 40)
        )
        stream = io.StringIO()
        ticks = iter((0.0, 0.0, 99.0))
        with RunLog(stream, clock=lambda ticks=ticks: next(ticks)) as view:
            view.progress("bake", done, total, "")
            view.progress("bake", done, total, "")
        assert "bake" in stream.getvalue()


def test_the_row_of_a_run_that_never_began_is_empty() -> None:
    assert [str(cell) for cell in run_row("x", RunState())] == ["x", "", "unfinished", "plan", "", ""]


def film_until(*rows: dict[str, Any]) -> RunState:
    """The dominoes' run up to its rendering, and these rows."""
    before = dominoes().rows
    place = next(place for place, row in enumerate(before) if row["type"] == "rendered")
    return run_state_after([*before[:place], *rows])


FITTED = {"type": "film.fitted", "round": 1, "width": 640, "height": 360, "samples": 12, "frames": 96,
          "seconds": 600.0, "minutes": 20.0, "lowered": "12 samples instead of 16"}  # fmt: skip


def test_a_film_says_what_was_lowered_and_how_long_it_takes() -> None:
    told = drawn(run_summary(film_until(FITTED)))
    assert "Film: 96 frames, 640×360, 12 samples, about 10 min of the 20 min that it may take" in told
    assert "lowered: 12 samples instead of 16" in told
    assert "about 10 min left" in told
    assert "about 5 min left" in drawn(run_summary(film_until(FITTED), frames=48))


def test_a_film_with_another_time_is_fitted_anew() -> None:
    same = film_until(FITTED, {"type": "sitting.began", "pid": 2})
    assert same.film_seconds == FITTED["seconds"]
    shorter = film_until(FITTED, {"type": "sitting.began", "pid": 2, "render_minutes": 1.0})
    assert shorter.film_seconds == 60.0


def test_the_rest_of_a_film_follows_from_the_frames_that_are_there() -> None:
    called = {
        "type": "tool.called",
        "role": "runner",
        "stage": "render",
        "attempt": 1,
        "n": 9,
        "name": "blender_render",
    }
    history = film_until(FITTED, called)
    (step,) = history.pending
    now = Now(step.began + 240.0, progress={"blender_render": ToolProgress(24, 96, "frame 24")})
    assert film_left(history, now) == pytest.approx(720.0), "240 s for a quarter of it"


def test_planning_is_not_time_of_the_first_stage() -> None:
    planned = until("stage.began")
    assert planned.planning >= 20.0
    assert "Planning" in drawn(run_summary(planned))
    assert (planned.stage("modeling") or planned.stages[0]).seconds == 0.0
