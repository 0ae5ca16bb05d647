"""A run as rich draws it: while it is worked on, as a whole, and as a row of a table of runs.

Only Text goes into what is drawn, never markup, and every text is cleaned: names and words come from anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rich import box
from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from agents.loop.run_state import ModelCall, ToolCall
from agents.plan.part import STAGES
from agents.protocol.report.text_format import plain
from agents.views.event_lines import told_findings
from agents.views.formatting import (
    counted,
    shortened,
    stage_title,
    told_attempt,
    told_clock,
    told_cost,
    told_source,
    told_time,
    told_tokens,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rich.console import RenderableType

    from agents.loop.run_state import Attempt, History, Step

_MARKS = {
    "closed": ("✓", "green"),
    "running": ("▶", "yellow"),
    "stopped": ("■", "yellow"),
    "aborted": ("✗", "red"),
    "failed": ("✗", "red"),
    "skipped": ("–", "dim"),
    "waiting": ("·", "dim"),
}
_OUTCOMES = {"done": "green", "aborted": "red", "failed": "red", "stopped": "yellow", "unfinished": "yellow"}
_TALL = 22  # lines of a terminal that has room for findings
_WIDEST = 400  # letters of a line, before the terminal cuts it
_ENOUGH = 0.2  # of the stages have to be done before it can be told how long the rest takes
_AT_LEAST = 0.2  # of a stage is always left
_BAR = 20
_SAID = 110  # letters of what is being said


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a tool has got."""

    done: float
    total: float | None
    text: str


@dataclass(frozen=True, slots=True)
class Now:
    """What goes on between two rows: ``seconds`` of work in all, words by role, progress by tool, the run's folder."""

    seconds: float
    words: Mapping[str, str] = field(default_factory=dict[str, str])
    progress: Mapping[str, Progress] = field(default_factory=dict[str, Progress])
    folder: str = ""


def working(history: History, now: Now, height: int) -> RenderableType:
    """The run, and what is being done in it, in at most about ``height`` lines."""
    parts: list[RenderableType] = [_head(history), _stages(history)]
    if history.ending is None:
        parts += _doing(history, now)
    stage = history.current
    judged = _last_judged(stage.attempts) if stage else None
    if judged and height >= _TALL:
        told = told_attempt(judged) or "is judged"
        parts += [_line(f"Attempt {judged.number}: {told}", "dim"), *_judged(judged, most=3, is_cut=True)]
    if history.ending and history.ending.why:
        parts.append(_line(history.ending.why, _OUTCOMES.get(history.outcome, "")))
    parts += [Text(), _foot(history, now)]
    return Group(*parts)


def show(history: History) -> RenderableType:
    """Everything that is worth knowing of a run, for ``simworlds show``."""
    parts: list[RenderableType] = [_head(history)]
    if history.title != history.prompt:
        parts.append(_line(history.prompt, "italic", most=_WIDEST * 4))
    parts.append(_stages(history))
    for stage in history.stages:
        for attempt in stage.attempts:
            if attempt.choice and attempt.choice.taken != "advance":
                parts.append(
                    _line(f"{stage_title(stage.name)}, attempt {attempt.number}: {told_attempt(attempt)}")
                )
                parts += _judged(attempt, most=5)
    for rendering in history.renderings:
        if rendering.review:
            verdict = "accepted" if rendering.review.verdict == "accept" else "needs a fix"
            parts.append(_line(f"Final review {rendering.round}: {verdict}. {rendering.review.summary}"))
    if history.changes and history.changes.outside:
        names = ", ".join(history.changes.outside[:12])
        parts.append(_line(f"Changed outside the request: {names}", "yellow"))
    if history.ending and history.ending.why:
        parts.append(_line(history.ending.why, _OUTCOMES.get(history.outcome, ""), most=_WIDEST * 4))
    parts += [Text(), _foot(history, Now(history.seconds))]
    return Group(*parts)


def runs_table(runs: Iterable[tuple[str, History]]) -> Table:
    """A row for each run: its name, what it is, how it stands, what it cost, when it was worked on last."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("Run", no_wrap=True)
    table.add_column("What", ratio=1, overflow="ellipsis", no_wrap=True)
    table.add_column("Outcome", no_wrap=True)
    table.add_column("Stage", no_wrap=True)
    table.add_column("Cost", justify="right", no_wrap=True)
    table.add_column("When", no_wrap=True)
    for name, history in runs:
        table.add_row(*run_row(name, history))
    return table


def run_row(name: str, history: History) -> tuple[Text, ...]:
    """The row of ``runs_table``."""
    stage = history.current
    if stage:
        where = stage_title(stage.name)
    else:
        where = (
            ""
            if history.outcome == "done"
            else stage_title(history.stages[-1].name)
            if history.stages
            else "plan"
        )
    when = history.latest.astimezone().strftime("%Y-%m-%d %H:%M") if history.latest else ""
    total = history.total
    cost = told_cost(total) if total.calls or total.cost else "recorded" if total.recorded else ""
    return (
        Text(shortened(name, 60)),
        Text(shortened(history.title, _WIDEST)),
        Text(shortened(history.outcome, 20), _OUTCOMES.get(history.outcome, "")),
        Text(where),
        Text(cost),
        Text(when),
    )


# Parts


def _line(text: str, style: str = "", most: int = _WIDEST) -> Text:
    return Text(shortened(text, most), style)


def _head(history: History) -> RenderableType:
    title = Text(shortened(history.title or "A new run", 120), "bold")
    if history.outcome != "unfinished":
        title.append(f"  {plain(history.outcome)}", _OUTCOMES.get(history.outcome, ""))
    source = told_source(history)
    return Group(title, _line(source, "yellow")) if source else title


def _stages(history: History) -> RenderableType:
    """A line for each stage: its mark, name, attempts, time."""
    table = Table.grid(padding=(0, 2, 0, 0))
    names = [*STAGES, *(one.name for one in history.stages if one.name not in STAGES)]
    for name in names:
        stage, state = history.stage(name), history.state_of(name)
        if state == "skipped" and history.mode == "edit":
            continue
        mark, style = _MARKS.get(state, ("?", ""))
        told = ""
        if stage and state != "skipped":
            last = stage.last
            several = counted(len(stage.attempts), "attempt") if len(stage.attempts) > 1 else ""
            running = f"attempt {last.number}" if last and state == "running" else several
            told = " · ".join(filter(None, [running, told_time(stage.seconds)]))
        shown = "bold" if state == "running" else "dim" if state in ("waiting", "skipped") else ""
        table.add_row(
            Text(mark, style), Text(shortened(stage_title(name), 40), shown), Text(told or state, "dim")
        )
    return Padding(table, (1, 0, 1, 0))


def _doing(history: History, now: Now) -> list[RenderableType]:
    """Who does what at this moment: a line for each that thinks, speaks or works, and the coder's last words."""
    stage = history.current
    attempt = stage.last if stage else None
    is_heard = any(isinstance(step, ModelCall) and step.role == "coder" for step in history.pending)
    words = "" if is_heard or attempt is None else _last_words(attempt)
    lines: list[RenderableType] = [_spoken("coder", words, "dim")] if words else []
    return [*lines, *(_step_line(step, now) for step in history.pending[-3:])]


def _last_words(attempt: Attempt) -> str:
    turns = (
        step.turn for step in reversed(attempt.steps) if isinstance(step, ModelCall) and step.role == "coder"
    )
    return next((turn.text for turn in turns if turn and turn.text.strip()), attempt.report)


def _spoken(role: str, words: str, style: str = "") -> Text:
    """The end of what a role has said so far."""
    line = Text(f"{plain(role).replace('_', ' ')} ", "cyan", no_wrap=True, overflow="ellipsis")
    return line.append(shortened(words[::-1], _SAID)[::-1], style or "default")


def _step_line(step: Step, now: Now) -> Text:
    line = Text(no_wrap=True, overflow="ellipsis")
    if isinstance(step, ToolCall):
        line.append(f"{plain(step.role)} ", "cyan").append(plain(step.name)[:60], "bold")
        progress = now.progress.get(step.name)
        if progress:
            if progress.total:
                share = min(1.0, max(0.0, progress.done / progress.total))
                full = round(share * _BAR)
                line.append(f"  {'━' * full}", "cyan").append("━" * (_BAR - full), "dim").append(
                    f" {share:.0%}"
                )
            line.append(f"  {shortened(progress.text, 120)}", "dim")
        else:
            line.append(f"  {told_time(max(0.0, now.seconds - step.began))}", "dim")
        return line
    words = now.words.get(step.role, "")
    thinks = f"thinks, {told_time(max(0.0, now.seconds - step.began))}"
    return _spoken(step.role, words) if words.strip() else _spoken(step.role, thinks, "dim")


def _last_judged(attempts: tuple[Attempt, ...]) -> Attempt | None:
    return next((one for one in reversed(attempts) if one.verification or one.review), None)


def _judged(attempt: Attempt, most: int, *, is_cut: bool = False) -> list[RenderableType]:
    """What was found of an attempt; lines that are too long for the terminal are cut, or wrapped."""
    found = attempt.verification
    told = told_findings(found, most) if found else []
    lines = [_line(one, "red" if found and found.hard else "yellow") for one in told]
    if attempt.review:
        verdict = "blocks" if attempt.review.blocking else "does not block"
        words = f"Reviewer {verdict}: {attempt.review.summary}"
        lines.append(_line(words, "red" if attempt.review.blocking else "green", most=200))
    for line in lines:
        line.no_wrap, line.overflow = is_cut, "ellipsis" if is_cut else None
    return [Padding(line, (0, 0, 0, 2)) for line in lines]


def _foot(history: History, now: Now) -> Text:
    total = history.total
    words = [told_clock(now.seconds)]
    if (left := seconds_left(history, now.seconds - history.seconds)) is not None:
        step = 60 if left >= 90 else 10  # it is no more exact than that
        words.append(f"about {told_time(max(1, round(left / step)) * step)} left")
    words.append(
        told_cost(total) if total.calls or not total.recorded else "recorded answers, nothing to pay"
    )
    if total.calls:
        words.append(told_tokens(total.usage))
    if now.folder:
        words.append(plain(now.folder))
    return Text(" · ".join(words), "dim", no_wrap=True, overflow="ellipsis")


def seconds_left(history: History, since: float = 0.0) -> float | None:
    """How long the rest may take if its stages are like those that are done, ``since`` seconds after the last row.

    None while that would be no more than a guess.
    """
    share, count = history.share_done, len(history.planned)
    if history.ending or not _ENOUGH <= share < 1:
        return None
    worked = sum(stage.seconds for stage in history.stages if stage.state == "closed")
    each = worked / (share * count)
    under_way = history.current.seconds if history.current else 0.0
    return max(each * _AT_LEAST, each * (1 - share) * count - under_way - since)
