"""The page: what the templates show, put together from a run's run_state and folder."""

from __future__ import annotations

import base64
import hashlib
import json
from contextlib import closing
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from agents.loop.record.reducer import read_run_state
from agents.loop.record.run_state import ModelCall, Step, ToolCall
from agents.plan.part import STAGES
from agents.protocol.report.grouping import group_findings
from agents.protocol.rules.catalogue import RULES
from agents.roles.names import ROLES, format_role
from agents.views import formatting
from agents.views.cost_table import KINDS, costs_by_role
from agents.views.report import code
from agents.views.report.links import CATEGORIES
from agents.views.report.media import Media, MediaItem
from agents.views.report.relation_graph import draw_graph
from agents.views.report.tables import objects_of, relations_of
from agents.views.report.timeline import draw_timeline
from simworlds.counting import counted
from simworlds.files import write_whole
from simworlds.formats.html_text import fit_for_html
from simworlds.llm.spending import SpendingRow as Spent
from simworlds.terminal.text import shortened

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.loop.record.events import Verified
    from agents.loop.record.run_state import Attempt, RunState, StageRun
    from agents.protocol.report.grouping import FindingGroup

NAME = "report.html"
_FOLDER = Path(__file__).parent / "templates"
_RULE_NAMES = {rule.id: rule.name for rule in RULES}
_ABOUT = 60  # letters
_PLAIN_STOPS = ("end_turn", "tool_use", "stop_sequence")


@dataclass(frozen=True, slots=True)
class GalleryPicture:
    """A picture that a role saw, with its number on the page."""

    number: int
    shown: MediaItem
    caption: str


@dataclass(frozen=True, slots=True)
class StepView:
    """What a role said, or a tool that it used."""

    step: Step
    words: str = ""
    stop: str = ""
    about: str = ""
    code: Markup | None = None
    arguments: Markup | None = None
    result: str = ""
    pictures: tuple[int, ...] = ()

    @property
    def is_tool(self) -> bool:
        """Whether it is a tool call."""
        return isinstance(self.step, ToolCall)

    @property
    def is_shown(self) -> bool:
        """Whether there is anything to see of it."""
        return self.is_tool or bool(self.words or self.stop)


@dataclass(frozen=True, slots=True)
class AttemptView:
    """An attempt, with all there is to see of it."""

    attempt: Attempt
    told: str
    state: str
    coder: tuple[StepView, ...]
    others: tuple[StepView, ...]
    pictures: tuple[GalleryPicture, ...]
    changes: tuple[tuple[code.ScriptChange, Markup], ...]
    findings: tuple[FindingGroup, ...]


@dataclass(frozen=True, slots=True)
class BeforeView:
    """What was said and done before any stage: the planning."""

    steps: tuple[StepView, ...]
    pictures: tuple[GalleryPicture, ...]


@dataclass(frozen=True, slots=True)
class StageView:
    """A stage, with its attempts and what it cost."""

    name: str
    title: str
    state: str
    run: StageRun | None = None
    spent: Spent = field(default_factory=lambda: Spent("", ""))
    attempts: tuple[AttemptView, ...] = ()
    before: tuple[StepView, ...] = ()
    pictures: tuple[GalleryPicture, ...] = ()


def write_report(run: Path) -> Path:
    """Writes report.html into the run's folder, from its journal; the file. Raises NoRun, OSError."""
    text = make_report(read_run_state(run), run)
    write_whole(run / NAME, text, durable=False)
    return run / NAME


def make_report(run_state: RunState, run: Path) -> str:
    """The page as HTML. ``run`` is the folder that its links start from, and has the pictures."""
    with closing(Media(run)) as media:
        return _render_page(run_state, run, media)


def _render_page(run_state: RunState, run: Path, media: Media) -> str:
    gallery = _Gallery(media)
    script = _own("script.js")
    page = _environment().get_template("page.html.jinja")
    text = page.render(
        run_state=run_state,
        run=run.resolve().name,
        source=formatting.describe_source(run_state),
        renderings=[_rendering(one, media) for one in run_state.renderings],
        result=_result(run_state, media),
        before=_before_stages(run_state, gallery),
        stages=_stages(run_state, gallery),
        graph=draw_graph(run_state.plan) if run_state.plan else None,
        timeline=draw_timeline(run_state.plan) if run_state.plan else None,
        objects=objects_of(run_state.plan) if run_state.plan else (),
        relations=relations_of(run_state.plan) if run_state.plan else (),
        costs=_costs(run_state),
        kinds=KINDS,
        by_kind=costs_by_role(run_state),
        roles=ROLES,
        counted=formatting.counted,
        describe_frames=formatting.describe_frames,
        categories=CATEGORIES,
        rule_names=_RULE_NAMES,
        style=Markup(_own("style.css")),  # noqa: S704 - our own file
        script=Markup(script),  # noqa: S704 - our own file
        script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        link=media.link,
    )
    return fit_for_html(text)


@cache
def _hard(verified: Verified) -> str:
    return ", ".join(formatting.format_hard(verified))


def _environment() -> Environment:
    made = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters.update(
        time=formatting.format_time,
        money=formatting.format_money,
        tokens=formatting.format_tokens,
        number=formatting.format_count,
        cost=formatting.format_cost,
        swatch=formatting.swatch,
        stage_title=formatting.stage_title,
        hard=_hard,
        clipped=code.clipped,
        role=format_role,
    )
    return made


def _own(name: str) -> str:
    return (_FOLDER / name).read_text("utf-8")


# The result


def _rendering(rendering: Any, media: Media) -> dict[str, Any]:
    return {
        "it": rendering,
        "frames": [shown for name in rendering.pictures if (shown := media.picture(name))],
    }


def _result(run_state: RunState, media: Media) -> dict[str, Any]:
    """The video or picture that stands for the run; the last of each that is there."""
    names = [run_state.ending.video or ""] if run_state.ending else []
    names += [one.path for one in reversed(run_state.renderings)]
    draft = run_state.draft
    names += [draft.path] if draft else []
    video = next((found for name in names if (found := media.video(name))), None)
    shown = [*reversed(run_state.renderings), *([draft] if draft else [])]
    stills = [*names, *(name for one in shown for name in one.pictures[-1:])]
    still = None if video else next((found for name in stills if (found := media.picture(name))), None)
    poster = next((one.pictures[0] for one in shown if one.pictures), "")
    file = (run_state.ending and run_state.ending.file) or ""
    return {
        "video": video,
        "still": still,
        "poster": media.picture(poster),
        "file": media.link(file),
        "name": file,
        "draft": [seen for name in draft.pictures if (seen := media.picture(name))] if draft else [],
        "film": formatting.describe_film(run_state.film) if run_state.film else "",
    }


# Stages


class _Gallery:
    """Every picture is on the page once; steps refer to it by its number."""

    def __init__(self, media: Media) -> None:
        self._media = media
        self._count = 0

    def of(self, steps: Sequence[Step]) -> tuple[tuple[GalleryPicture, ...], dict[str, int]]:
        """The pictures of these steps, and their numbers by path."""
        seen: list[GalleryPicture] = []
        numbers: dict[str, int] = {}
        for step in steps:
            if not isinstance(step, ToolCall):
                continue
            for path in step.pictures:
                shown = None if path in numbers else self._media.picture(path)
                if shown:
                    self._count += 1
                    numbers[path] = self._count
                    seen.append(GalleryPicture(self._count, shown, _caption(step)))
        return tuple(seen), numbers


def _caption(call: ToolCall) -> str:
    name = call.name.removeprefix("blender_").replace("_", " ")
    about = _about(call)
    return f"{format_role(call.role)}: {name}" + (f" ({about})" if about else "")


def _about(call: ToolCall) -> str:
    """What a call is about: the length of its code, or its arguments as far as they are short."""
    if call.code:
        return counted(len(call.code.splitlines()), "line")
    given = (
        ", ".join(map(str, value)) if isinstance(value, list) else str(value)
        for value in call.input.values()
        if isinstance(value, (str, list))
    )
    return shortened(", ".join(given), _ABOUT)


def _before_stages(run_state: RunState, gallery: _Gallery) -> BeforeView:
    pictures, numbers = gallery.of(run_state.steps)
    steps = (_step(step, numbers) for step in run_state.steps)
    return BeforeView(tuple(one for one in steps if one.is_shown), pictures)


def _stages(run_state: RunState, gallery: _Gallery) -> list[StageView]:
    names = [*STAGES, *(one.name for one in run_state.stages if one.name not in STAGES)]
    if run_state.mode == "edit" and run_state.edit:
        names = [name for name in names if name in run_state.planned or run_state.stage(name)]
    shown: list[StageView] = []
    for name in names:
        run = run_state.stage(name)
        spent = sum((row for row in run_state.spending if row.stage == name), Spent("", name))
        state = run_state.state_of(name)
        if run is None:
            shown.append(StageView(name, formatting.stage_title(name), state))
            continue
        pictures, numbers = gallery.of(run.steps)
        before = tuple(_step(step, numbers) for step in run.steps if isinstance(step, ToolCall))
        attempts = tuple(
            _attempt(attempt, run.attempts[:place], gallery) for place, attempt in enumerate(run.attempts)
        )
        shown.append(
            StageView(name, formatting.stage_title(name), state, run, spent, attempts, before, pictures)
        )
    return shown


def _attempt(attempt: Attempt, before: Sequence[Attempt], gallery: _Gallery) -> AttemptView:
    pictures, numbers = gallery.of(attempt.steps)
    coder = [_step(step, numbers) for step in attempt.steps if step.role == "coder"]
    others = [
        _step(step, numbers) for step in attempt.steps if step.role != "coder" and isinstance(step, ToolCall)
    ]
    taken = attempt.choice.taken if attempt.choice else ""
    made = code.changes(before, attempt) if before else []
    return AttemptView(
        attempt=attempt,
        told=formatting.describe_attempt(attempt),
        state={"advance": "closed", "abort": "aborted"}.get(taken, "sent-back" if taken else "open"),
        coder=tuple(one for one in coder if one.is_shown),
        others=tuple(others),
        pictures=pictures,
        changes=tuple((one, code.highlighted(one.diff, "diff")) for one in made),
        findings=tuple(group_findings(attempt.verification.findings)) if attempt.verification else (),
    )


def _step(step: Step, numbers: dict[str, int]) -> StepView:
    if isinstance(step, ModelCall):
        if step.turn is None:
            return StepView(step, stop="unreadable" if step.is_answered else "never answered")
        stop = "" if step.turn.stop_reason in _PLAIN_STOPS else step.turn.stop_reason
        return StepView(step, words=step.turn.text.strip(), stop=stop)
    rest = {name: value for name, value in step.input.items() if not (name == "code" and step.code)}
    told = json.dumps(rest, ensure_ascii=False, indent=2)
    return StepView(
        step,
        about=_about(step),
        code=code.highlighted(step.code, "python") if step.code else None,
        arguments=code.highlighted(told, "json") if rest else None,
        result="\n\n".join(step.texts).strip(),
        pictures=tuple(numbers[path] for path in step.pictures if path in numbers),
    )


# Costs


def _costs(run_state: RunState) -> list[dict[str, Any]]:
    """A row for each stage that used a model, and what is outside of any."""
    by_key = {(row.role, row.stage): row for row in run_state.spending}
    names = list(dict.fromkeys(row.stage for row in run_state.spending))
    ordered = sorted(names, key=lambda name: (name in STAGES, STAGES.index(name) if name in STAGES else 0))
    return [
        {
            "title": formatting.stage_title(name) if name else "Scene plan",
            "roles": [by_key.get((role, name)) for role in ROLES],
            "total": sum((row for row in run_state.spending if row.stage == name), Spent("", name)),
            "seconds": stage.seconds if (stage := run_state.stage(name)) else run_state.planning or None,
        }
        for name in ordered
    ]
