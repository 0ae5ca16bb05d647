"""Reduces a run's events to its state.

``after`` is the whole of it: a state and an event give the next state. It never raises: events of unknown types change
nothing but the clock, and what an event speaks of without its having begun has begun.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Any

from agents.loop.record import events
from agents.loop.record.journal import NAME, read_rows
from agents.loop.record.run_state import Attempt, ModelCall, Rendering, RunState, StageRun, Step, ToolCall
from simworlds.llm.messages import Text
from simworlds.llm.spending import SpendingRow

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from simworlds.llm.messages import Turn


_PICTURE = re.compile(r"^<picture image/\w+>$", re.MULTILINE)
_BUILDING = (events.PlanMade, events.StageMoved, events.TacticMade, events.AttemptBegan)


def run_state_after(rows: Iterable[Mapping[str, Any]], before: RunState | None = None) -> RunState:
    """The state that ``rows`` of a journal, oldest first, lead to from ``before`` on."""
    return reduce(after, map(events.read_event, rows), before or RunState())


def read_run_state(run: Path) -> RunState:
    """The state of the run in a folder; an empty one without a journal. Raises NoRun for what is not a journal."""
    return run_state_after(read_rows(run / NAME))


def after(state: RunState, event: events.Event) -> RunState:  # noqa: PLR0911, PLR0912 - a case for each type of event
    """The state once ``event`` has happened."""
    state = _on_the_clock(state, event)
    if isinstance(event, _BUILDING):
        state = replace(state, is_building=True)
    elif not state.is_building and isinstance(event, (events.ToolCalled, events.ToolAnswered)):
        event = event.model_copy(update={"stage": ""})  # made ready for the first stage, while it is planned
    match event:
        case events.RunBegan():
            return _run_began(state, event)
        case events.SessionBegan():
            return _session_began(state, event)
        case events.PlanMade():
            return replace(state, plan=event.plan or state.plan, edit=event.edit or state.edit)
        case events.StageMoved():
            return _stage_moved(state, event)
        case events.TacticMade():
            return _with_attempt(state, event, tactic=event.plan)
        case events.AttemptBegan():
            return _with_attempt(state, event)
        case events.AttemptEnded():
            return _with_attempt(state, event, report=event.report, ended=event.ended)
        case events.Verified():
            return _with_attempt(state, event, verification=event)
        case events.Reviewed():
            return _with_attempt(state, event, review=event.review, lines=event.lines)
        case events.Decided():
            return _with_attempt(state, event, choice=event)
        case events.RolledBack():
            return _with_attempt(state, event, rolled_back=event.to)
        case events.ModelAsked():
            return _model_asked(state, event)
        case events.ToolCalled():
            return _begin(state, ToolCall(**_place(state, event), name=event.name, input=event.input))
        case events.ModelAnswered():
            return _model_answered(state, event)
        case events.ToolAnswered():
            return _tool_answered(state, event)
        case events.Drafted():
            return replace(state, draft=event)
        case events.FilmFitted():
            return replace(state, film=event)
        case events.FilmDecided():
            return replace(state, before_film=event)
        case events.SceneRendered():
            return _rendered(state, event)
        case events.FinalReviewed():
            return _final_reviewed(state, event)
        case events.Edited():
            return replace(state, changes=event)
        case events.RunEnded():
            return _run_ended(state, event)
        case _:
            return state


# Time


def _on_the_clock(state: RunState, event: events.Event) -> RunState:
    """Counts the time since the last event as work, except between two sessions."""
    now = event.t
    passed = 0.0
    if now and state.latest and not isinstance(event, events.SessionBegan):
        passed = max(0.0, (now - state.latest).total_seconds())
    state = replace(
        state,
        rows=state.rows + 1,
        settled=None,
        began=state.began or now,
        latest=now or state.latest,
        seconds=state.seconds + passed,
    )
    if not state.is_building:
        return replace(state, planning=state.planning + passed)
    stage = state.stage(event.stage or (state.current.name if state.current else ""))
    if not passed or not stage:
        return state
    attempts = stage.attempts
    if stage.last:
        attempts = (*attempts[:-1], replace(stage.last, seconds=stage.last.seconds + passed))
    return _put(state, replace(stage, seconds=stage.seconds + passed, attempts=attempts))


# Stages and attempts


def _put(state: RunState, stage: StageRun) -> RunState:
    """Puts the stage in place of the one of its name, or at the end."""
    if state.stage(stage.name) is None:
        return replace(state, stages=(*state.stages, stage))
    return replace(state, stages=tuple(stage if old.name == stage.name else old for old in state.stages))


def _stage_moved(state: RunState, event: events.StageMoved) -> RunState:
    if not event.stage:
        return state
    stage = state.stage(event.stage) or StageRun(event.stage)
    name = {"stage.began": "running", "stage.skipped": "skipped", "stage.closed": "closed"}[event.type]
    return _put(state, replace(stage, state=name, file=event.file or stage.file))


def _attempt(stage: StageRun, number: int | None) -> Attempt:
    """The attempt of that number; the newest, or the first, where there is no number."""
    wanted = number if number is not None else stage.last.number if stage.last else 1
    known = next((attempt for attempt in stage.attempts if attempt.number == wanted), None)
    return known or Attempt(stage.name, wanted)


def _put_attempt(state: RunState, stage: StageRun, attempt: Attempt) -> RunState:
    others = [other for other in stage.attempts if other.number != attempt.number]
    attempts = tuple(sorted([*others, attempt], key=lambda other: other.number))
    return _put(state, replace(stage, attempts=attempts))


def _with_attempt(state: RunState, event: events.Event, **changes: Any) -> RunState:
    """Changes fields of the attempt that the event is about."""
    if not event.stage:
        return state
    stage = state.stage(event.stage) or StageRun(event.stage)
    return _put_attempt(state, stage, replace(_attempt(stage, event.attempt), **changes))


# Steps


def _put_step(state: RunState, step: Step, *, instead_of: Step | None = None) -> RunState:
    """Puts the step at the end, or in place of another, wherever that stands."""

    def put(steps: tuple[Step, ...]) -> tuple[Step, ...]:
        if instead_of is None:
            return (*steps, step)
        return tuple(step if old is instead_of else old for old in steps)

    if not step.stage:
        return replace(state, steps=put(state.steps))
    # An edit's file is judged, as its last stage will be, before any stage begins.
    stage = state.stage(step.stage) or StageRun(step.stage, "waiting")
    if not step.attempt:
        return _put(state, replace(stage, steps=put(stage.steps)))
    if stage.state == "waiting":  # no event begins the last stage
        stage = replace(stage, state="running")
    attempt = _attempt(stage, step.attempt)
    return _put_attempt(state, stage, replace(attempt, steps=put(attempt.steps)))


def _place(state: RunState, event: events.Event) -> dict[str, Any]:
    """The fields of all steps: who, where, and when."""
    stage = state.stage(event.stage)
    newest = stage.last.number if stage and stage.last else 0
    return {
        "n": event.n or 0,
        "role": event.role,
        "stage": event.stage,
        "attempt": newest if event.attempt is None else event.attempt,
        "began": state.seconds,
    }


def _begin(state: RunState, step: Step) -> RunState:
    state = _put_step(state, step)
    return replace(state, pending=(*state.pending, step))


def _model_asked(state: RunState, event: events.ModelAsked) -> RunState:
    pictures = sum(_pictures(event.texts.get(part, "")) for part in set(event.parts) - state.sent)
    state = replace(state, sent=state.sent.union(event.parts))
    return _begin(state, ModelCall(**_place(state, event), model=event.model, pictures=pictures))


def _pictures(text: str) -> int:
    """How many pictures there are in what a model was told, as ``simworlds.llm.records.canonical`` writes it."""
    return len(_PICTURE.findall(text))


def _open(state: RunState, event: events.Event, kind: type[Step]) -> Step | None:
    """The newest step without an answer that the event's answer may belong to."""
    about = {name: getattr(event, name) for name in ("n", "attempt", "role", "stage")}
    known = {name: value for name, value in about.items() if value not in (None, "")}
    fitting = (
        step
        for step in reversed(state.pending)
        if isinstance(step, kind) and all(getattr(step, name) == value for name, value in known.items())
    )
    return next(fitting, None)


def _settle(state: RunState, old: Step, new: Step) -> RunState:
    left = tuple(step for step in state.pending if step is not old)
    state = replace(state, pending=left, settled=new)
    return _put_step(state, new, instead_of=old)


def _model_answered(state: RunState, event: events.ModelAnswered) -> RunState:
    asked = _open(state, event, ModelCall)
    if not isinstance(asked, ModelCall):
        return state
    seconds = state.seconds - asked.began
    state = _settle(state, asked, replace(asked, turn=event.turn, seconds=seconds, is_answered=True))
    return _charged(state, asked, event.turn) if event.turn else state


def _charged(state: RunState, asked: ModelCall, turn: Turn) -> RunState:
    row = SpendingRow(asked.role, asked.stage, recorded=1)
    if turn.live:
        row = SpendingRow.paid(asked.role, asked.stage, turn)
    rows = {(other.role, other.stage): other for other in state.spending}
    key = (row.role, row.stage)
    rows[key] = rows[key] + row if key in rows else row
    return replace(state, spending=tuple(rows.values()))


def _tool_answered(state: RunState, event: events.ToolAnswered) -> RunState:
    called = _open(state, event, ToolCall)
    if not isinstance(called, ToolCall):
        return state
    content = event.content or ()
    answered = replace(
        called,
        seconds=state.seconds - called.began if event.seconds is None else event.seconds,
        texts=tuple(part.text for part in content if isinstance(part, Text)),
        pictures=tuple(part.path for part in content if isinstance(part, events.PicturePart)),
        failed=event.failed,
        checkpoint=event.checkpoint,
        is_answered=True,
    )
    return _settle(state, called, answered)


# The run


def _run_began(state: RunState, event: events.RunBegan) -> RunState:
    return replace(
        state,
        mode=event.mode,
        prompt=event.prompt,
        version=event.version,
        blender=event.blender,
        source=event.source,
        models=event.models,
        options=event.options,
    )


def _session_began(state: RunState, event: events.SessionBegan) -> RunState:
    minutes = event.render_minutes
    options = state.options if minutes is None else {**state.options, "render_minutes": minutes}
    # A film that gets other samples or another time is fitted anew.
    is_fitted = minutes is None and event.render_samples is None
    return replace(
        state,
        sessions=state.sessions + 1,
        ending=None,
        options=options,
        limit=event.max_minutes,
        film=state.film if is_fitted or state.renderings else None,
    )


def _rendered(state: RunState, event: events.SceneRendered) -> RunState:
    number = event.round or len(state.renderings) + 1
    rendering = Rendering(
        number, event.kind, event.path, event.frames, event.seconds, event.samples, event.pictures
    )
    others = (other for other in state.renderings if other.round != number)
    state = _put(state, state.stage("render") or StageRun("render"))
    return replace(state, renderings=(*others, rendering))


def _final_reviewed(state: RunState, event: events.FinalReviewed) -> RunState:
    known = [rendering.round for rendering in state.renderings]
    if not known:
        rendering = Rendering(event.round or 1, review=event.review, lines=event.lines)
        return replace(state, renderings=(rendering,))
    number = event.round if event.round in known else known[-1]
    return replace(
        state,
        renderings=tuple(
            replace(rendering, review=event.review, lines=event.lines)
            if rendering.round == number
            else rendering
            for rendering in state.renderings
        ),
    )


def _run_ended(state: RunState, event: events.RunEnded) -> RunState:
    render = state.stage("render")
    if event.outcome == "done" and render and render.state == "running":  # no event closes the last stage
        state = _put(state, replace(render, state="closed"))
    return replace(state, ending=event)
