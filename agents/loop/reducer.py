"""Reads a journal's rows into the picture of the run.

``after`` is the whole of it: a picture and a row give the next picture. It never raises: rows that it does not know are
passed over, fields that are not what they should be are taken as missing, and what a row speaks of without its having
begun has begun.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Any, cast

from pydantic import TypeAdapter, ValidationError

from agents.loop.fields import Fields
from agents.loop.journal import NAME, read_rows
from agents.loop.run_state import (
    Attempt,
    Changes,
    Choice,
    Ending,
    History,
    ModelCall,
    Rendering,
    StageRun,
    Step,
    ToolCall,
    Verification,
)
from agents.plan.edit import EditPlan
from agents.plan.scene import ScenePlan
from agents.plan.tactical import Decision, FinalReview, Review, TacticalPlan
from agents.protocol.findings import Finding
from simworlds.llm.messages import Turn
from simworlds.llm.spending import SpendingRow

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path

_TURN = TypeAdapter(Turn)
_FINDING = TypeAdapter(Finding)


def history_of(rows: Iterable[Mapping[str, Any]], before: History | None = None) -> History:
    """The picture that ``rows`` make, oldest first, after ``before``."""
    return reduce(after, rows, before or History())


def read_history(run: Path) -> History:
    """The picture of the run in a folder; an empty one where it has no journal. Raises NoRun for what is no journal."""
    return history_of(read_rows(run / NAME))


def after(history: History, row: Mapping[str, Any]) -> History:
    """The picture once ``row`` has happened."""
    fields = Fields(row)
    kind = fields.text("type")
    history = _on_the_clock(history, fields, is_new_sitting=kind == "sitting.began")
    change = _CHANGES.get(kind)
    return change(history, fields) if change else history


# Time


def _on_the_clock(history: History, fields: Fields, *, is_new_sitting: bool) -> History:
    """What has passed since the last row is work, unless nobody was there."""
    now = fields.time()
    passed = 0.0
    if now and history.latest and not is_new_sitting:
        passed = max(0.0, (now - history.latest).total_seconds())
    history = replace(
        history,
        rows=history.rows + 1,
        settled=None,
        began=history.began or now,
        latest=now or history.latest,
        seconds=history.seconds + passed,
    )
    name = fields.text("stage") or (history.current.name if history.current else "")
    stage = history.stage(name)
    if not passed or not stage:
        return history
    attempts = stage.attempts
    if stage.last:
        attempts = (*attempts[:-1], replace(stage.last, seconds=stage.last.seconds + passed))
    return _put(history, replace(stage, seconds=stage.seconds + passed, attempts=attempts))


# Stages and attempts


def _put(history: History, stage: StageRun) -> History:
    """With the stage in place of the one of its name, or as the newest."""
    if history.stage(stage.name) is None:
        return replace(history, stages=(*history.stages, stage))
    return replace(history, stages=tuple(stage if one.name == stage.name else one for one in history.stages))


def _stage(history: History, fields: Fields) -> StageRun:
    name = fields.text("stage")
    return history.stage(name) or StageRun(name)


def _attempt(stage: StageRun, number: int | None) -> Attempt:
    """The attempt of that number; the newest, or the first, where none is given."""
    wanted = number if number is not None else stage.last.number if stage.last else 1
    found = next((one for one in stage.attempts if one.number == wanted), None)
    return found or Attempt(stage.name, wanted)


def _with_attempt(stage: StageRun, attempt: Attempt) -> StageRun:
    others = [one for one in stage.attempts if one.number != attempt.number]
    return replace(stage, attempts=tuple(sorted([*others, attempt], key=lambda one: one.number)))


def _changed(**make: Callable[[Fields], Any]) -> Callable[[History, Fields], History]:
    """A change of an attempt: its fields, each made from the row's."""

    def change(history: History, fields: Fields) -> History:
        stage = _stage(history, fields)
        if not stage.name:
            return history
        attempt = _attempt(stage, fields.whole("attempt"))
        made = {name: value(fields) for name, value in make.items()}
        return _put(history, _with_attempt(stage, replace(attempt, **made)))

    return change


def _state(state: str) -> Callable[[History, Fields], History]:
    def change(history: History, fields: Fields) -> History:
        stage = _stage(history, fields)
        if not stage.name:
            return history
        return _put(history, replace(stage, state=state, file=fields.text("file") or stage.file))

    return change


def _verification(fields: Fields) -> Verification:
    findings = tuple(found for one in fields.items("findings") if (found := _finding(one)))
    broken = [one.severity for one in findings if one.outcome == "broken"]
    hard, soft = fields.whole("hard"), fields.whole("soft")
    return Verification(
        ok=fields.flag("ok"),
        hard=broken.count("hard") if hard is None else hard,
        soft=broken.count("soft") if soft is None else soft,
        seconds=fields.number("seconds"),
        findings=findings,
    )


def _finding(given: object) -> Finding | None:
    try:
        return _FINDING.validate_python(given)
    except (ValidationError, RecursionError):
        return None


def _choice(fields: Fields) -> Choice:
    decision = fields.model("decision", Decision)
    taken = fields.text("taken") or (decision.transition if decision else "")
    return Choice(decision, taken, fields.flag("overruled"), fields.text("why"))


# Steps


def _step_put(history: History, step: Step, *, instead_of: Step | None = None) -> History:
    """With the step at the end, or in place of another, wherever that stands."""

    def put(steps: tuple[Step, ...]) -> tuple[Step, ...]:
        if instead_of is None:
            return (*steps, step)
        return tuple(step if one is instead_of else one for one in steps)

    if not step.stage:
        return replace(history, steps=put(history.steps))
    stage = history.stage(step.stage) or StageRun(step.stage)
    if not step.attempt:
        return _put(history, replace(stage, steps=put(stage.steps)))
    attempt = _attempt(stage, step.attempt)
    return _put(history, _with_attempt(stage, replace(attempt, steps=put(attempt.steps))))


def _place(history: History, fields: Fields) -> dict[str, Any]:
    """What all steps have: who, where, and when."""
    stage = history.stage(fields.text("stage"))
    newest = stage.last.number if stage and stage.last else 0
    attempt = fields.whole("attempt")
    return {
        "n": fields.whole("n") or 0,
        "role": fields.text("role"),
        "stage": fields.text("stage"),
        "attempt": newest if attempt is None else attempt,
        "began": history.seconds,
    }


def _asked(history: History, fields: Fields) -> History:
    return _begin(history, ModelCall(**_place(history, fields), model=fields.text("model")))


def _called(history: History, fields: Fields) -> History:
    call = ToolCall(**_place(history, fields), name=fields.text("name"), input=fields.mapping("input") or {})
    return _begin(history, call)


def _begin(history: History, step: Step) -> History:
    history = _step_put(history, step)
    return replace(history, pending=(*history.pending, step))


def _open(history: History, fields: Fields, kind: type[Step]) -> Step | None:
    """The newest step without an answer that the row's answer may belong to."""
    given: dict[str, Any] = {
        name: value
        for name, value in (("n", fields.whole("n")), ("attempt", fields.whole("attempt")))
        if value is not None
    }
    given.update({name: fields.text(name) for name in ("role", "stage") if fields.text(name)})
    fitting = (
        step
        for step in reversed(history.pending)
        if isinstance(step, kind) and all(getattr(step, name) == value for name, value in given.items())
    )
    return next(fitting, None)


def _settle(history: History, old: Step, new: Step) -> History:
    left = tuple(step for step in history.pending if step is not old)
    history = replace(history, pending=left, settled=new)
    return _step_put(history, new, instead_of=old)


def _model_answered(history: History, fields: Fields) -> History:
    asked = _open(history, fields, ModelCall)
    if not isinstance(asked, ModelCall):
        return history
    try:
        turn = _TURN.validate_python(fields.mapping("turn"))
    except (ValidationError, RecursionError):
        turn = None
    spent = history.seconds - asked.began
    history = _settle(history, asked, replace(asked, turn=turn, seconds=spent, is_answered=True))
    return _charged(history, asked, turn) if turn else history


def _charged(history: History, asked: ModelCall, turn: Turn) -> History:
    row = SpendingRow(asked.role, asked.stage, recorded=1)
    if turn.live:
        row = SpendingRow(
            asked.role, asked.stage, 1, turn.usage + turn.lost, turn.cost or 0.0, int(turn.cost is None)
        )
    rows = {(one.role, one.stage): one for one in history.spending}
    key = (row.role, row.stage)
    rows[key] = rows[key] + row if key in rows else row
    return replace(history, spending=tuple(rows.values()))


def _tool_answered(history: History, fields: Fields) -> History:
    called = _open(history, fields, ToolCall)
    if not isinstance(called, ToolCall):
        return history
    blocks = [Fields(cast("dict[str, Any]", one)) for one in fields.items("content") if isinstance(one, dict)]
    seconds = fields.number("seconds")
    answered = replace(
        called,
        seconds=history.seconds - called.began if seconds is None else seconds,
        texts=tuple(one.text("text") for one in blocks if one.text("type") == "text"),
        pictures=tuple(one.text("path") for one in blocks if one.text("type") == "picture"),
        data=fields.mapping("data") or {},
        failed=fields.flag("failed"),
        checkpoint=fields.whole("checkpoint"),
        is_answered=True,
    )
    return _settle(history, called, answered)


# The run


def _run_began(history: History, fields: Fields) -> History:
    models = fields.mapping("models") or {}
    return replace(
        history,
        mode=fields.text("mode"),
        prompt=fields.text("prompt"),
        version=fields.text("version"),
        blender=fields.text("blender"),
        source=fields.text("source"),
        models={role: name for role, name in models.items() if isinstance(name, str)},
        options=fields.mapping("options") or {},
        file=fields.text("file"),
        reference=fields.text("reference"),
    )


def _sitting_began(history: History, _fields: Fields) -> History:
    return replace(history, sittings=history.sittings + 1, ending=None)


def _plan(history: History, fields: Fields) -> History:
    plan, edit = fields.model("plan", ScenePlan), fields.model("edit", EditPlan)
    return replace(history, plan=plan or history.plan, edit=edit or history.edit)


def _rendered(history: History, fields: Fields) -> History:
    number = fields.whole("round") or len(history.renderings) + 1
    rendering = Rendering(
        round=number,
        kind=fields.text("kind"),
        path=fields.text("path"),
        frames=fields.count("frames"),
        seconds=fields.number("seconds"),
        samples=fields.whole("samples"),
        pictures=_paths(fields.items("pictures")),
    )
    others = (one for one in history.renderings if one.round != number)
    history = _put(history, history.stage("render") or StageRun("render"))
    return replace(history, renderings=(*others, rendering))


def _paths(given: list[Any]) -> tuple[str, ...]:
    """Paths, bare or as content blocks."""
    found = (one.get("path") if isinstance(one, dict) else one for one in given)
    return tuple(path for path in found if isinstance(path, str))


def _final_reviewed(history: History, fields: Fields) -> History:
    number, review = fields.whole("round"), fields.model("review", FinalReview)
    if not history.renderings:
        return replace(history, renderings=(Rendering(number or 1, review=review),))
    known = {one.round for one in history.renderings}
    number = number if number in known else history.renderings[-1].round
    return replace(
        history,
        renderings=tuple(
            replace(one, review=review) if one.round == number else one for one in history.renderings
        ),
    )


def _edited(history: History, fields: Fields) -> History:
    names = ("added", "removed", "changed", "unchanged", "outside")
    found = {name: tuple(one for one in fields.items(name) if isinstance(one, str)) for name in names}
    return replace(history, changes=Changes(**found, notes=_notes(fields)))


def _notes(fields: Fields) -> dict[str, str]:
    """{data-block: what of it differs; what that follows from}."""
    parts, why = fields.mapping("parts") or {}, fields.mapping("why") or {}
    told: dict[str, str] = {}
    for name in [*parts, *(name for name in why if name not in parts)]:
        listed = parts.get(name)
        differing = ", ".join(map(str, cast("list[Any]", listed))) if isinstance(listed, list) else ""
        reason = why.get(name)
        told[name] = "; ".join(filter(None, [differing, reason if isinstance(reason, str) else ""]))
    return told


def _run_ended(history: History, fields: Fields) -> History:
    names = ("outcome", "why", "file", "video")
    ending = Ending(**{name: fields.text(name) for name in names})
    render = history.stage("render")
    if ending.outcome == "done" and render and render.state == "running":  # nobody closes the last stage
        history = _put(history, replace(render, state="closed"))
    return replace(history, ending=ending)


_CHANGES: dict[str, Callable[[History, Fields], History]] = {
    "run.began": _run_began,
    "sitting.began": _sitting_began,
    "plan": _plan,
    "stage.began": _state("running"),
    "stage.skipped": _state("skipped"),
    "stage.closed": _state("closed"),
    "tactic": _changed(tactic=lambda fields: fields.model("plan", TacticalPlan)),
    "attempt.began": _changed(),
    "attempt.ended": _changed(
        report=lambda fields: fields.text("report"), ended=lambda fields: fields.text("ended")
    ),
    "verified": _changed(verification=_verification),
    "reviewed": _changed(review=lambda fields: fields.model("review", Review)),
    "decided": _changed(choice=_choice),
    "rolled.back": _changed(rolled_back=lambda fields: fields.text("to")),
    "model.asked": _asked,
    "model.answered": _model_answered,
    "tool.called": _called,
    "tool.answered": _tool_answered,
    "rendered": _rendered,
    "final.reviewed": _final_reviewed,
    "edited": _edited,
    "run.ended": _run_ended,
}
