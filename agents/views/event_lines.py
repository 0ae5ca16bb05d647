"""Formats the events of a run as lines of a log; most events have none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.record import events
from agents.loop.record.run_state import ModelCall, ToolCall
from agents.protocol.report.grouping import group_findings
from agents.views.formatting import (
    describe_attempt,
    describe_film,
    describe_frames,
    describe_source,
    format_cost,
    format_hard,
    format_time,
    stage_title,
)
from agents.views.now import Now
from agents.views.time_left import describe_time_left
from simworlds.counting import counted
from simworlds.terminal.text import shortened

if TYPE_CHECKING:
    from agents.loop.record.run_state import RunState, StageRun, Step

_WORDS = 140
_FINDINGS = 3


def format_event(event: events.Event, run_state: RunState) -> list[str]:  # noqa: PLR0911, PLR0912 - a case for each type
    """Lines for an event; ``run_state`` has it already. They may hold control characters: clean them."""
    stage = run_state.stage(event.stage) if event.stage else run_state.current
    match event:
        case events.RunBegan():
            source = describe_source(run_state)
            return [f"{event.mode or 'run'}: {event.prompt}", *([source] if source else [])]
        case events.SessionBegan():
            return [f"Resumed, session {run_state.sessions}."] if run_state.sessions > 1 else []
        case events.PlanMade():
            return _plan(run_state)
        case events.ModelAnswered() | events.ToolAnswered():
            return _step(run_state.settled)
        case events.Verified():
            return _verified(event)
        case events.Reviewed(review=review) if review:
            verdict = "blocks" if review.blocks else "does not block"
            return [f"  reviewer {verdict}: {shortened(review.summary, _WORDS)}"]
        case events.RolledBack():
            return [f"  back to {event.to}"]
        case events.Drafted():
            return [f"Draft: {event.path or 'no preview'}, {counted(len(event.pictures), 'still')}"]
        case events.FilmFitted():
            return [describe_film(event)]
        case events.FilmDecided(decision=decision) if decision:
            wanted = "go on" if decision.transition == "film" else "mend first"
            return [f"Before the film: {wanted}: {shortened(decision.reason, _WORDS)}"]
        case events.MendWeighed(is_time=False):
            return ["There is no time left to mend that and to render again"]
        case events.SceneRendered():
            rendered = event.frames or 1
            frames = f", {describe_frames(rendered, run_state.film)}" if rendered > 1 else ""
            return [f"Rendered: {event.path}{frames}, {format_time(event.seconds)}"]
        case events.FinalReviewed(review=review) if review:
            verdict = "accepted" if review.verdict == "accept" else "needs a fix"
            return [f"Final review: {verdict}: {shortened(review.summary, _WORDS)}"]
        case events.Edited():
            return _edited(event)
        case events.RunEnded():
            why = f": {event.why}" if event.why else ""
            cost = format_cost(run_state.total)
            return [f"Run {event.outcome}{why}", f"{format_time(run_state.seconds)} of work, cost: {cost}"]
        case _:
            return _stage_lines(event, stage, run_state) if stage else []


def _stage_lines(event: events.Event, stage: StageRun, run_state: RunState) -> list[str]:
    name, last = stage_title(stage.name), stage.last
    match event:
        case events.StageMoved():
            return [_moved(event, stage, run_state)]
        case events.AttemptBegan() if last:
            return [f"{name}, attempt {last.number}"]
        case events.Withdrew(decision=decision) if decision:
            told = "; ".join(map(str, decision.withdraw))
            return [f"{name}: the planner withdraws {told}: {shortened(decision.reason, _WORDS)}"]
        case events.Decided(decision=decision) if last:
            reason = decision.reason if decision else event.why
            wanted = f" (it wanted to {decision.transition})" if decision and event.overruled else ""
            why = f": {shortened(reason, _WORDS)}" if reason else ""
            return [f"{name}, attempt {last.number} {describe_attempt(last)}{wanted}{why}"]
        case _:
            return []


def _moved(event: events.StageMoved, stage: StageRun, run_state: RunState) -> str:
    name = stage_title(stage.name)
    match event.type:
        case "stage.began":
            return f"{name} begins"
        case "stage.skipped":
            return f"{name}: skipped, the plan does not need it"
        case _:
            attempts = counted(len(stage.attempts), "attempt")
            left = describe_time_left(run_state, Now(run_state.seconds))
            return f"{name} closed after {attempts}, {format_time(stage.seconds)}{left and f' ({left})'}"


def _plan(run_state: RunState) -> list[str]:
    if run_state.plan:
        objects, relations = len(run_state.plan.objects), len(run_state.plan.relations)
        what = f"{counted(objects, 'object')}, {counted(relations, 'relation')}"
    elif run_state.edit:
        what = counted(len(run_state.edit.tasks), "task")
    else:
        return []
    return [f"Plan: {run_state.title} ({what})"]


def _step(step: Step | None) -> list[str]:
    match step:
        case ModelCall(role="coder", turn=turn) if turn and (words := turn.text.strip()):
            return [f"  coder: {shortened(words, _WORDS)}"]
        case ToolCall(role="coder" | "runner"):
            why = f": {shortened(' '.join(step.texts), _WORDS)}" if step.failed else ""
            return [f"  {step.name} {'failed' if step.failed else 'done'}, {format_time(step.seconds)}{why}"]
        case _:
            return []


def _verified(event: events.Verified) -> list[str]:
    verdict = "no hard finding" if event.ok else ", ".join(format_hard(event)) or "undecided"
    soft = f", {counted(event.soft, 'soft finding')}" if event.soft else ""
    return [f"  verifier: {verdict}{soft}", *(f"    {line}" for line in format_findings(event, _FINDINGS))]


def format_findings(verified: events.Verified, most: int) -> list[str]:
    """The worst findings, those that say the same in one line, and how many kinds there are more."""
    folded = group_findings(verified.findings)
    lines: list[str] = []
    for row in folded[:most]:
        many = f" ×{len(row.findings)}" if len(row.findings) > 1 else ""
        objects = " ".join(row.objects(2).split("\n"))
        measured = f" [{row.measured}]" if row.measured else ""
        lines.append(f"{' '.join(filter(None, [row.worst.rule + many, objects]))}: {row.message}{measured}")
    more = [f"and {counted(len(folded) - most, 'more kind')}"] if len(folded) > most else []
    return [*lines, *more]


def _edited(event: events.Edited) -> list[str]:
    counts = [(len(getattr(event, name)), name) for name in ("added", "removed", "changed", "unchanged")]
    lines = ["Data-blocks: " + ", ".join(f"{count} {name}" for count, name in counts)]
    outside = f"Warning: changed outside the request: {', '.join(map(event.describe, event.outside[:8]))}"
    return [*lines, *([outside] if event.outside else [])]
