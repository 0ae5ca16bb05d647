"""A run as rich draws it: while it is worked on, as a whole, and as a row of a table of runs.

Only Text goes into what is drawn, never markup, and every text is cleaned: names and words come from anywhere.
"""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from rich import box
from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from agents.loop.record.run_state import ModelCall, ToolCall
from agents.loop.running.run_tools import RENDER
from agents.plan.part import STAGES
from agents.roles.names import format_role
from agents.views.cost_table import KINDS, costs_by_role
from agents.views.event_lines import format_findings
from agents.views.formatting import (
    describe_attempt,
    describe_film,
    describe_source,
    format_clock,
    format_cost,
    format_count,
    format_money,
    format_time,
    format_tokens,
    stage_title,
)
from agents.views.now import Now, ToolProgress
from agents.views.time_left import describe_time_left
from simworlds.counting import counted
from simworlds.terminal.text import plain, shortened

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import RenderableType

    from agents.loop.record.run_state import Attempt, RunState, Step

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
_LONGEST_NAME, _LONGEST_PATH = 60, 4096  # letters of a run's
_BAR = 20
_SAID = 110  # letters of what is being said


def run_in_progress(run_state: RunState, now: Now, height: int) -> RenderableType:
    """The run, and what is being done in it, in at most about ``height`` lines."""
    parts: list[RenderableType] = [_head(run_state), _stages(run_state)]
    if run_state.ending is None:
        parts += _doing(run_state, now)
    stage = run_state.current
    judged = _last_judged(stage.attempts) if stage else None
    if judged and height >= _TALL:
        told = describe_attempt(judged) or "is judged"
        parts += [_line(f"Attempt {judged.number}: {told}", "dim"), *_judged(judged, most=3, is_cut=True)]
    if run_state.ending and run_state.ending.why:
        parts.append(_line(run_state.ending.why, _OUTCOMES.get(run_state.outcome, "")))
    parts += [Text(), _foot(run_state, now)]
    return Group(*parts)


def run_summary(run_state: RunState, frames: int = 0) -> RenderableType:
    """A summary of the run, for ``simworlds show``. ``frames``: how many frames of its film are there by now."""
    parts: list[RenderableType] = [_head(run_state)]
    if run_state.title != run_state.prompt:
        parts.append(_line(run_state.prompt, "italic", most=_WIDEST * 4))
    parts.append(_stages(run_state))
    for stage in run_state.stages:
        for attempt in stage.attempts:
            if attempt.choice and attempt.choice.taken != "advance":
                parts.append(
                    _line(f"{stage_title(stage.name)}, attempt {attempt.number}: {describe_attempt(attempt)}")
                )
                parts += _judged(attempt, most=5)
    if run_state.film and not run_state.renderings:
        parts.append(_line(describe_film(run_state.film)))
    for rendering in run_state.renderings:
        if rendering.review:
            verdict = "accepted" if rendering.review.verdict == "accept" else "needs a fix"
            parts.append(_line(f"Final review {rendering.round}: {verdict}. {rendering.review.summary}"))
    if run_state.changes and run_state.changes.outside:
        names = ", ".join(run_state.changes.outside[:12])
        parts.append(_line(f"Changed outside the request: {names}", "yellow"))
    if run_state.ending and run_state.ending.why:
        parts.append(_line(run_state.ending.why, _OUTCOMES.get(run_state.outcome, ""), most=_WIDEST * 4))
    film = run_state.film
    progress = {RENDER: ToolProgress(frames, film.frames, "frames")} if film and frames else {}
    parts += [*_costs(run_state), Text(), _foot(run_state, Now(run_state.seconds, progress=progress))]
    return Group(*parts)


def runs_table(runs: Iterable[tuple[str, RunState]], *, by_path: bool = False) -> Table:
    """A row for each run: its name, what it is, how it stands, what it cost, when it was worked on last.

    ``by_path``: their names are paths, which may be long.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    if by_path:
        table.add_column("Run elsewhere", overflow="fold", min_width=13)
    else:
        table.add_column("Run", no_wrap=True)
    # The columns that wrap in a narrow terminal, so that names and outcomes stay whole.
    table.add_column("What", min_width=10)
    table.add_column("Outcome", no_wrap=True)
    table.add_column("Stage", min_width=11)
    table.add_column("Cost", justify="right", min_width=8)
    table.add_column("When", no_wrap=True)
    for name, run_state in runs:
        table.add_row(*run_row(name, run_state, longest=_LONGEST_PATH if by_path else _LONGEST_NAME))
    return table


def _day(moment: datetime | None) -> str:
    """The day in local time, of today the hour instead: so much stays whole in a narrow terminal."""
    if moment is None:
        return ""
    local = moment.astimezone()
    return local.strftime("%H:%M" if local.date() == datetime.now().astimezone().date() else "%Y-%m-%d")


def run_row(name: str, run_state: RunState, longest: int = _LONGEST_NAME) -> tuple[Text, ...]:
    """The row of ``runs_table``."""
    stage = run_state.current
    if stage:
        where = stage_title(stage.name)
    else:
        where = (
            ""
            if run_state.outcome == "done"
            else stage_title(run_state.stages[-1].name)
            if run_state.stages
            else "plan"
        )
    total = run_state.total
    cost = format_cost(total) if total.calls or total.cost else "recorded" if total.recorded else ""
    return (
        Text(shortened(name, longest)),
        Text(shortened(run_state.title, _WIDEST)),
        Text(shortened(run_state.outcome, 20), _OUTCOMES.get(run_state.outcome, "")),
        Text(where),
        Text(cost),
        Text(_day(run_state.latest)),
    )


# Parts


def _line(text: str, style: str = "", most: int = _WIDEST) -> Text:
    return Text(shortened(text, most), style)


def _head(run_state: RunState) -> RenderableType:
    title = Text(shortened(run_state.title or "A new run", 120), "bold")
    if run_state.outcome != "unfinished":
        title.append(f"  {plain(run_state.outcome)}", _OUTCOMES.get(run_state.outcome, ""))
    source = describe_source(run_state)
    return Group(title, _line(source, "yellow")) if source else title


def _stages(run_state: RunState) -> RenderableType:
    """A line for each stage: its mark, name, attempts, time."""
    table = Table.grid(padding=(0, 2, 0, 0))
    if run_state.planning:
        mark, style = _MARKS[run_state.planning_state]
        table.add_row(Text(mark, style), Text("Planning"), Text(format_time(run_state.planning), "dim"))
    names = [*STAGES, *(one.name for one in run_state.stages if one.name not in STAGES)]
    for name in names:
        stage, state = run_state.stage(name), run_state.state_of(name)
        if state == "skipped" and run_state.mode == "edit":
            continue
        mark, style = _MARKS.get(state, ("?", ""))
        told = ""
        if stage and state not in ("skipped", "waiting"):
            last = stage.last
            several = counted(len(stage.attempts), "attempt") if len(stage.attempts) > 1 else ""
            running = f"attempt {last.number}" if last and state == "running" else several
            told = " · ".join(filter(None, [running, format_time(stage.seconds)]))
        shown = "bold" if state == "running" else "dim" if state in ("waiting", "skipped") else ""
        table.add_row(
            Text(mark, style), Text(shortened(stage_title(name), 40), shown), Text(told or state, "dim")
        )
    return Padding(table, (1, 0, 1, 0))


def _doing(run_state: RunState, now: Now) -> list[RenderableType]:
    """Who does what at this moment: a line for each that thinks, speaks or works, and the coder's last words."""
    stage = run_state.current
    attempt = stage.last if stage else None
    is_heard = any(isinstance(step, ModelCall) and step.role == "coder" for step in run_state.pending)
    words = "" if is_heard or attempt is None else _last_words(attempt)
    lines: list[RenderableType] = [_spoken("coder", words, "dim")] if words else []
    return [*lines, *(_step_line(step, now) for step in run_state.pending[-3:])]


def _last_words(attempt: Attempt) -> str:
    turns = (
        step.turn for step in reversed(attempt.steps) if isinstance(step, ModelCall) and step.role == "coder"
    )
    return next((turn.text for turn in turns if turn and turn.text.strip()), attempt.report)


def _costs(run_state: RunState) -> list[RenderableType]:
    """Tokens and dollars by role and kind, where a model was paid for."""
    rows = costs_by_role(run_state)
    if not rows:
        return []
    headings = ("Calls", "Pictures", *KINDS.values(), "Cost")
    numbers = [
        (
            *map(format_count, (row.calls, row.pictures)),
            *(
                f"{format_count(getattr(row.usage, kind))} {format_money(row.dollars[kind])}"
                for kind in KINDS
            ),
            format_money(row.cost) + (f" + {row.unpriced} unpriced" if row.unpriced else ""),
        )
        for row in rows
    ]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    table.add_column("Role", no_wrap=True)
    for heading, *cells in zip(headings, *numbers, strict=True):
        # Between words it may break, where the terminal is narrow.
        widest = max(len(word) for cell in (heading, *cells) for word in cell.split())
        table.add_column(heading, justify="right", min_width=widest)
    for row, cells in zip(rows, numbers, strict=True):
        role = Text(shortened(format_role(row.role) or "all", 20), "" if row.role else "bold")
        table.add_row(role, *map(Text, cells))
    return [Text(), table]


def _spoken(role: str, words: str, style: str = "") -> Text:
    """The end of what a role has said so far."""
    line = Text(f"{format_role(plain(role))} ", "cyan", no_wrap=True, overflow="ellipsis")
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
            line.append(f"  {format_time(max(0.0, now.seconds - step.began))}", "dim")
        return line
    words = now.words.get(step.role, "")
    thinks = f"thinks, {format_time(max(0.0, now.seconds - step.began))}"
    return _spoken(step.role, words) if words.strip() else _spoken(step.role, thinks, "dim")


def _last_judged(attempts: tuple[Attempt, ...]) -> Attempt | None:
    return next((one for one in reversed(attempts) if one.verification or one.review), None)


def _judged(attempt: Attempt, most: int, *, is_cut: bool = False) -> list[RenderableType]:
    """What was found of an attempt; lines that are too long for the terminal are cut, or wrapped."""
    found = attempt.verification
    told = format_findings(found, most) if found else []
    lines = [_line(one, "red" if found and found.hard else "yellow") for one in told]
    if attempt.review:
        verdict = "blocks" if attempt.review.blocks else "does not block"
        words = f"Reviewer {verdict}: {attempt.review.summary}"
        lines.append(_line(words, "red" if attempt.review.blocks else "green", most=200))
    for line in lines:
        line.no_wrap, line.overflow = is_cut, "ellipsis" if is_cut else None
    return [Padding(line, (0, 0, 0, 2)) for line in lines]


def _foot(run_state: RunState, now: Now) -> Text:
    total = run_state.total
    words = [format_clock(now.seconds)]
    if left := describe_time_left(run_state, now):
        words.append(left)
    words.append(
        format_cost(total) if total.calls or not total.recorded else "recorded answers, nothing to pay"
    )
    if total.calls:
        words.append(format_tokens(total.usage))
    if now.folder:
        words.append(plain(now.folder))
    return Text(" · ".join(words), "dim", no_wrap=True, overflow="ellipsis")
