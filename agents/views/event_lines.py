"""The rows of a journal as lines that one can follow; most rows are worth none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.loop.run_state import ModelCall, ToolCall
from agents.protocol.report.grouping import group_findings
from agents.views.formatting import (
    counted,
    shortened,
    stage_title,
    told_attempt,
    told_cost,
    told_source,
    told_time,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from agents.loop.run_state import Attempt, History, StageRun, Verification

_WORDS = 140
_FINDINGS = 3
_WATCHED = ("coder", "runner")


def told_event(row: Mapping[str, Any], history: History) -> list[str]:
    """Lines for a row; ``history`` is the picture that has it already. They may hold anything: clean them."""
    tell = _LINES.get(str(row.get("type")))
    stage = history.stage(str(row.get("stage"))) if row.get("stage") else history.current
    return tell(row, history, stage) if tell else []


def _named(stage: StageRun | None) -> str:
    return stage_title(stage.name) if stage else ""


def _last(stage: StageRun | None) -> Attempt | None:
    return stage.last if stage else None


def _run_began(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    source = told_source(history)
    return [f"{history.mode or 'run'}: {history.prompt}", *([source] if source else [])]


def _sitting_began(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    return [f"Taken up again, sitting {history.sittings}."] if history.sittings > 1 else []


def _plan(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    if history.plan:
        objects, relations = len(history.plan.objects), len(history.plan.relations)
        what = f"{counted(objects, 'object')}, {counted(relations, 'relation')}"
    elif history.edit:
        what = counted(len(history.edit.tasks), "task")
    else:
        return []
    return [f"Plan: {history.title} ({what})"]


def _stage_began(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    return [f"{_named(stage)} begins"]


def _skipped(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    return [f"{_named(stage)}: skipped, the plan does without it"]


def _attempt_began(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    last = _last(stage)
    return [f"{_named(stage)}, attempt {last.number}"] if last else []


def _model_answered(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    call = history.settled
    if not isinstance(call, ModelCall) or call.turn is None or call.role != "coder":
        return []
    words = call.turn.text.strip()
    return [f"  {call.role}: {shortened(words, _WORDS)}"] if words else []


def _tool_answered(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    call = history.settled
    if not isinstance(call, ToolCall) or call.role not in _WATCHED:
        return []
    why = f": {shortened(' '.join(call.texts), _WORDS)}" if call.failed else ""
    return [f"  {call.name} {'failed' if call.failed else 'done'}, {told_time(call.seconds)}{why}"]


def _verified(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    last = _last(stage)
    found = last.verification if last else None
    if found is None:
        return []
    verdict = (
        "no hard finding" if found.ok else counted(found.hard, "hard finding") if found.hard else "undecided"
    )
    soft = f", {counted(found.soft, 'soft finding')}" if found.soft else ""
    return [f"  verifier: {verdict}{soft}", *(f"    {line}" for line in told_findings(found, _FINDINGS))]


def told_findings(found: Verification, most: int) -> list[str]:
    """The worst findings, those that say the same in one line, and how many kinds there are more."""
    folded = group_findings(found.findings)
    lines: list[str] = []
    for row in folded[:most]:
        many = f" ×{len(row.findings)}" if len(row.findings) > 1 else ""
        whom = " ".join(row.objects(2).split("\n"))
        measured = f" [{row.measured}]" if row.measured else ""
        lines.append(f"{' '.join(filter(None, [row.worst.rule + many, whom]))}: {row.message}{measured}")
    return [*lines, *([f"and {len(folded) - most} kinds more"] if len(folded) > most else [])]


def _reviewed(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    last = _last(stage)
    review = last.review if last else None
    if review is None:
        return []
    verdict = "blocks" if review.blocking else "does not block"
    return [f"  reviewer {verdict}: {shortened(review.summary, _WORDS)}"]


def _decided(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    last = _last(stage)
    if last is None or last.choice is None:
        return []
    decision = last.choice.decision
    reason = decision.reason if decision else last.choice.why
    wanted = f" (it wanted to {decision.transition})" if decision and last.choice.overruled else ""
    return [
        f"{_named(stage)}, attempt {last.number} {told_attempt(last)}{wanted}: {shortened(reason, _WORDS)}"
    ]


def _rolled_back(row: Mapping[str, Any], _history: History, _stage: StageRun | None) -> list[str]:
    return [f"  back to {row.get('to')}"]


def _closed(_row: Mapping[str, Any], _history: History, stage: StageRun | None) -> list[str]:
    attempts = counted(len(stage.attempts), "attempt") if stage else ""
    return [f"{_named(stage)} closed after {attempts}, {told_time(stage.seconds)}"] if stage else []


def _rendered(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    made = history.renderings[-1]
    frames = f", {counted(made.frames, 'frame')}" if made.frames and made.frames > 1 else ""
    return [f"Rendered: {made.path}{frames}, {told_time(made.seconds)}"]


def _final_reviewed(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    review = next((one.review for one in reversed(history.renderings) if one.review), None)
    if review is None:
        return []
    verdict = "accepted" if review.verdict == "accept" else "needs a fix"
    return [f"Final review: {verdict}: {shortened(review.summary, _WORDS)}"]


def _edited(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    if history.changes is None:
        return []
    found = history.changes
    counts = [(len(getattr(found, name)), name) for name in ("added", "removed", "changed", "unchanged")]
    lines = ["Data-blocks: " + ", ".join(f"{count} {name}" for count, name in counts)]
    outside = f"Warning: changed outside the request: {', '.join(map(found.told, found.outside[:8]))}"
    return [*lines, *([outside] if found.outside else [])]


def _run_ended(_row: Mapping[str, Any], history: History, _stage: StageRun | None) -> list[str]:
    ending = history.ending
    if ending is None:
        return []
    why = f": {ending.why}" if ending.why else ""
    return [
        f"Run {ending.outcome}{why}",
        f"{told_time(history.seconds)} of work, cost: {told_cost(history.total)}",
    ]


_LINES: dict[str, Callable[[Mapping[str, Any], History, StageRun | None], list[str]]] = {
    "run.began": _run_began,
    "sitting.began": _sitting_began,
    "plan": _plan,
    "stage.began": _stage_began,
    "stage.skipped": _skipped,
    "attempt.began": _attempt_began,
    "model.answered": _model_answered,
    "tool.answered": _tool_answered,
    "verified": _verified,
    "reviewed": _reviewed,
    "decided": _decided,
    "rolled.back": _rolled_back,
    "stage.closed": _closed,
    "rendered": _rendered,
    "final.reviewed": _final_reviewed,
    "edited": _edited,
    "run.ended": _run_ended,
}
