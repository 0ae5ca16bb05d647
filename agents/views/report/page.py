"""The page: what the templates show, put together from a run's history and folder."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from agents.loop.reducer import read_history
from agents.loop.run_state import ModelCall, Step, ToolCall
from agents.plan.part import STAGES
from agents.protocol.report.folding import rows
from agents.protocol.rules.catalogue import RULES
from agents.views import formatting
from agents.views.report import code
from agents.views.report.links import CATEGORIES
from agents.views.report.media import Media, Shown
from agents.views.report.relation_graph import draw_graph
from agents.views.report.tables import objects_of, relations_of
from agents.views.report.timeline import draw_timeline
from simworlds.files import write_whole
from simworlds.llm.spending import SpendingRow as Spent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.loop.run_state import Attempt, History, StageRun
    from agents.protocol.report.folding import Row

NAME = "report.html"
_FOLDER = Path(__file__).parent / "templates"
_ROLES = ("planner", "coder", "reviewer", "final_reviewer")
_RULE_NAMES = {rule.id: rule.name for rule in RULES}
_ABOUT = 60  # letters
_PLAIN_STOPS = ("end_turn", "tool_use", "stop_sequence")
# What HTML has no place for, and what turns the direction of the text that is read.
_UNFIT = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\u202a-\u202e\u2066-\u2069\ufffe\uffff]")


@dataclass(frozen=True, slots=True)
class Seen:
    """A picture that a role saw, with its number on the page."""

    number: int
    shown: Shown
    caption: str


@dataclass(frozen=True, slots=True)
class ShownStep:
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


@dataclass(frozen=True, slots=True)
class ShownAttempt:
    """An attempt, with all there is to see of it."""

    attempt: Attempt
    told: str
    state: str
    coder: tuple[ShownStep, ...]
    others: tuple[ShownStep, ...]
    pictures: tuple[Seen, ...]
    changes: tuple[tuple[code.Change, Markup], ...]
    findings: tuple[Row, ...]


@dataclass(frozen=True, slots=True)
class ShownStage:
    """A stage, with its attempts and what it cost."""

    name: str
    title: str
    state: str
    run: StageRun | None = None
    spent: Spent = field(default_factory=lambda: Spent("", ""))
    attempts: tuple[ShownAttempt, ...] = ()
    before: tuple[ShownStep, ...] = ()
    pictures: tuple[Seen, ...] = ()


def write_report(run: Path) -> Path:
    """Writes report.html into the run's folder, from its journal; the file. Raises NoRun, OSError."""
    text = make_report(read_history(run), run)
    write_whole(run / NAME, text, durable=False)
    return run / NAME


def make_report(history: History, run: Path) -> str:
    """The page as HTML. ``run`` is the folder that its links start from, and has the pictures."""
    media = Media(run)
    gallery = _Gallery(media)
    script = _own("script.js")
    page = _environment().get_template("page.html.jinja")
    text = page.render(
        history=history,
        run=run.resolve().name,
        source=formatting.told_source(history),
        renderings=[_rendering(one, media) for one in history.renderings],
        result=_result(history, media),
        stages=_stages(history, gallery),
        graph=draw_graph(history.plan) if history.plan else None,
        timeline=draw_timeline(history.plan) if history.plan else None,
        objects=objects_of(history.plan) if history.plan else (),
        relations=relations_of(history.plan) if history.plan else (),
        costs=_costs(history),
        roles=_ROLES,
        counted=formatting.counted,
        categories=CATEGORIES,
        rule_names=_RULE_NAMES,
        style=Markup(_own("style.css")),  # noqa: S704 - our own file
        script=Markup(script),  # noqa: S704 - our own file
        script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        link=media.link,
    )
    return _UNFIT.sub("\N{REPLACEMENT CHARACTER}", text)


@cache
def _environment() -> Environment:
    made = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters.update(
        time=formatting.told_time,
        money=formatting.told_money,
        tokens=formatting.told_tokens,
        number=formatting.told_count,
        cost=formatting.told_cost,
        swatch=formatting.swatch,
        stage_title=formatting.stage_title,
        clipped=code.clipped,
        role=_told_role,
    )
    return made


def _own(name: str) -> str:
    return (_FOLDER / name).read_text("utf-8")


def _told_role(role: str) -> str:
    return role.replace("_", " ")


# The result


def _rendering(rendering: Any, media: Media) -> dict[str, Any]:
    return {
        "it": rendering,
        "frames": [shown for name in rendering.pictures if (shown := media.picture(name))],
    }


def _result(history: History, media: Media) -> dict[str, Any]:
    """The video or picture that stands for the run; the last of each that is there."""
    names = [history.ending.video] if history.ending else []
    names += [one.path for one in reversed(history.renderings)]
    video = next((shown for name in names if (shown := media.video(name))), None)
    stills = [*names, *(name for one in reversed(history.renderings) for name in one.pictures[-1:])]
    still = None if video else next((shown for name in stills if (shown := media.picture(name))), None)
    poster = next((one.pictures[0] for one in reversed(history.renderings) if one.pictures), "")
    file = history.ending.file if history.ending else ""
    return {
        "video": video,
        "still": still,
        "poster": media.picture(poster),
        "file": media.link(file),
        "name": file,
    }


# Stages


class _Gallery:
    """Every picture is on the page once; steps refer to it by its number."""

    def __init__(self, media: Media) -> None:
        self._media = media
        self._count = 0

    def of(self, steps: Sequence[Step]) -> tuple[tuple[Seen, ...], dict[str, int]]:
        """The pictures of these steps, and their numbers by path."""
        seen: list[Seen] = []
        numbers: dict[str, int] = {}
        for step in steps:
            if not isinstance(step, ToolCall):
                continue
            for path in step.pictures:
                shown = None if path in numbers else self._media.picture(path)
                if shown:
                    self._count += 1
                    numbers[path] = self._count
                    seen.append(Seen(self._count, shown, _caption(step)))
        return tuple(seen), numbers


def _caption(call: ToolCall) -> str:
    name = call.name.removeprefix("blender_").replace("_", " ")
    about = _about(call)
    return f"{_told_role(call.role)}: {name}" + (f" ({about})" if about else "")


def _about(call: ToolCall) -> str:
    """What a call is about: the length of its code, or its arguments as far as they are short."""
    if call.code:
        return formatting.counted(len(call.code.splitlines()), "line")
    given = (
        ", ".join(map(str, value)) if isinstance(value, list) else str(value)
        for value in call.input.values()
        if isinstance(value, (str, list))
    )
    return formatting.shortened(", ".join(given), _ABOUT)


def _stages(history: History, gallery: _Gallery) -> list[ShownStage]:
    names = [*STAGES, *(one.name for one in history.stages if one.name not in STAGES)]
    if history.mode == "edit" and history.edit:
        names = [name for name in names if name in history.planned or history.stage(name)]
    shown: list[ShownStage] = []
    for name in names:
        run = history.stage(name)
        spent = sum((row for row in history.spending if row.stage == name), Spent("", name))
        state = history.state_of(name)
        if run is None:
            shown.append(ShownStage(name, formatting.stage_title(name), state))
            continue
        pictures, numbers = gallery.of(run.steps)
        before = tuple(_step(step, numbers) for step in run.steps if isinstance(step, ToolCall))
        attempts = tuple(
            _attempt(attempt, run.attempts[:place], gallery) for place, attempt in enumerate(run.attempts)
        )
        shown.append(
            ShownStage(name, formatting.stage_title(name), state, run, spent, attempts, before, pictures)
        )
    return shown


def _attempt(attempt: Attempt, before: Sequence[Attempt], gallery: _Gallery) -> ShownAttempt:
    pictures, numbers = gallery.of(attempt.steps)
    coder = [_step(step, numbers) for step in attempt.steps if step.role == "coder"]
    others = [
        _step(step, numbers) for step in attempt.steps if step.role != "coder" and isinstance(step, ToolCall)
    ]
    taken = attempt.choice.taken if attempt.choice else ""
    made = code.changes(before, attempt) if before else []
    return ShownAttempt(
        attempt=attempt,
        told=formatting.told_attempt(attempt),
        state={"advance": "closed", "abort": "aborted"}.get(taken, "sent-back" if taken else "open"),
        coder=tuple(one for one in coder if one.is_tool or one.words or one.stop),
        others=tuple(others),
        pictures=pictures,
        changes=tuple((one, code.highlighted(one.diff, "diff")) for one in made),
        findings=tuple(rows(attempt.verification.findings)) if attempt.verification else (),
    )


def _step(step: Step, numbers: dict[str, int]) -> ShownStep:
    if isinstance(step, ModelCall):
        if step.turn is None:
            return ShownStep(step, stop="unreadable" if step.is_answered else "never answered")
        stop = "" if step.turn.stop_reason in _PLAIN_STOPS else step.turn.stop_reason
        return ShownStep(step, words=step.turn.text.strip(), stop=stop)
    rest = {name: value for name, value in step.input.items() if not (name == "code" and step.code)}
    told = json.dumps(rest, ensure_ascii=False, indent=2)
    return ShownStep(
        step,
        about=_about(step),
        code=code.highlighted(step.code, "python") if step.code else None,
        arguments=code.highlighted(told, "json") if rest else None,
        result="\n\n".join(step.texts).strip(),
        pictures=tuple(numbers[path] for path in step.pictures if path in numbers),
    )


# Costs


def _costs(history: History) -> list[dict[str, Any]]:
    """A row for each stage that used a model, and what is outside of any."""
    by_key = {(row.role, row.stage): row for row in history.spending}
    names = list(dict.fromkeys(row.stage for row in history.spending))
    ordered = sorted(names, key=lambda name: (name in STAGES, STAGES.index(name) if name in STAGES else 0))
    return [
        {
            "title": formatting.stage_title(name) if name else "Scene plan",
            "roles": [by_key.get((role, name)) for role in _ROLES],
            "total": sum((row for row in history.spending if row.stage == name), Spent("", name)),
            "seconds": stage.seconds if (stage := history.stage(name)) else None,
        }
        for name in ordered
    ]
