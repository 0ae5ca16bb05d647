"""A run: its folder, its journal, its tools and its limits.

The folder holds ``journal.jsonl``, ``plan.json``, ``checkpoints/STAGE.blend``, ``pictures/`` (what the roles saw, by
content), ``blender/`` (the worker's own), ``scene.blend`` (of the last closed stage, in the end the result), and in the
end ``video.mp4`` or ``still.png``, and ``report.html``.
"""

from __future__ import annotations

import hashlib
import json
import threading
import time
from collections import Counter
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from agents.blender.saved_files import move_saved
from agents.blender.tool_catalogue import BY_NAME
from agents.blender.tools.scene_order import words_of
from agents.loop.edit.baseline import told_since
from agents.loop.errors import NoRun, NotSaved, RunError, Stopping
from agents.loop.film.planned_settings import code_of
from agents.loop.film.telling_frames import MeasuredMotion
from agents.loop.record.events import (
    AttemptBegan,
    AttemptEnded,
    PicturePart,
    RolledBack,
    SceneRestored,
    SessionBegan,
    TimeTold,
    ToolAnswered,
    ToolCalled,
)
from agents.loop.review.acceptance import AcceptanceRecord
from agents.loop.review.withdrawals import as_soft
from agents.loop.running.interruptible import Interruptible
from agents.loop.running.tool_client import ToolOutcome
from agents.roles import coder, planner, reviewer
from agents.roles.base import RoleContext
from simworlds.counting import format_list
from simworlds.files import write_whole
from simworlds.llm.messages import Picture, Text, ToolResult

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from agents.loop.options import Options, RunLimits
    from agents.loop.record.journal import Journal
    from agents.loop.running.tool_client import ToolClient
    from agents.loop.task import RunTask
    from agents.plan.part import Stage
    from agents.plan.tactical import Withdrawal
    from agents.roles.base import WorkResult
    from simworlds.llm.messages import Model, Tool, ToolUse

RUNNER, VERIFIER = "runner", "verifier"
VERIFY = "blender_verify"
CHECK = "blender_check"
_EXCHANGE = ("blender_import", "blender_export")
RENDER = "blender_render"
START = "start"
_KEPT_STILLS = 2
_LISTED = 12
_LEAVING_SECONDS = 120.0  # of a session's limit, for saving and showing what stands
_TIME_LEFT = "About {} minutes are left; then the run ends with what stands."
_UNUSED = "Not saved, since nothing uses it any more: {} (use it, or set its use_fake_user, to keep it)."
SCENE = "scene.blend"
_MOST_WORDS = 60  # of an instruction
# What a reviewer sees with, and nothing else; what the verifier says follows from the scene alone, too.
_LOOKS = frozenset(tool.name for tool in BY_NAME.values() if tool.shows_scene)
_SHOWING = _LOOKS | {VERIFY}


@dataclass(frozen=True, slots=True)
class Still:
    """A picture that was rendered, with what the tool said of it, and the checkpoint of its scene."""

    text: str
    picture: Picture
    checkpoint: int | None


@dataclass
class Run:
    """What the loop works with. Two threads may call at the same time.

    ``stills``: the last pictures that the coder rendered in this attempt.
    ``acceptance``: what the plans of the closed stages wanted, and whether it holds. ``motion``: what the motion
    stage's reviewer was shown of it. ``withdrawn``: what of the plan no longer counts. ``stage`` is
    being built, ``closed`` was closed last; ``is_changed``: whether the scene is another since. ``is_leaving``: the run
    has stopped; calls are neither journalled nor refused.
    """

    root: Path
    options: Options
    limits: RunLimits
    journal: Journal
    tools: ToolClient
    model: Model
    saying: Callable[[str, str], object]
    stop: threading.Event = field(default_factory=threading.Event)
    attempt: int | None = None
    task: RunTask | None = None
    stills: list[Still] = field(default_factory=list["Still"])
    acceptance: AcceptanceRecord = field(default_factory=AcceptanceRecord)
    motion: MeasuredMotion = field(default_factory=MeasuredMotion)
    withdrawn: list[Withdrawal] = field(default_factory=list["Withdrawal"])
    stage: Stage | None = None
    closed: str = START
    is_changed: bool = False
    is_leaving: bool = False
    _unused: dict[str, bool] = field(
        default_factory=dict[str, bool]
    )  # what no file has: whether that is still to be told
    _checkpoint: int | None = None
    _seen: dict[str, ToolOutcome] = field(default_factory=dict[str, ToolOutcome])
    _began: float = field(default_factory=time.monotonic)
    _calls: Counter[tuple[str, str]] = field(default_factory=Counter[tuple[str, str]])
    _aligned: bool = False
    _door: threading.RLock = field(default_factory=threading.RLock)

    @cached_property
    def context(self) -> RoleContext:
        """What the roles work with."""
        return RoleContext(
            Interruptible(self.model, self.stop),
            self.options.model,
            tools=lambda role, stage: RoleTools(self, role, stage),
            saying=self.saying,
            safe=self.safe,
            names=self.options.models,
            verifier=self.options.verifier,
            staged=self.options.stages,
        )

    @property
    def render_minutes(self) -> float | None:
        """How long a film may take: what was said last, as the run began or was resumed."""
        said = self.journal.newest(SessionBegan, value=lambda began: began.render_minutes)
        return said or self.options.render_minutes

    @property
    def samples(self) -> int | None:
        """The samples of a film, instead of the plan's: what was said last."""
        said = self.journal.newest(SessionBegan, value=lambda began: began.render_samples)
        return said or self.options.samples

    @property
    def checkpoints(self) -> Path:
        """The folder of the stages' files, which tools can only read."""
        return self.root / "checkpoints"

    def safe(self) -> None:
        """A safe point: called before everything that costs time or money. Raises Stopping."""
        if self.stop.is_set():
            raise Stopping("You asked the run to stop.")
        left = self.seconds_left
        if left is not None and left < 0:
            raise Stopping(f"The limit of {self.limits.max_minutes:g} minutes is reached.")

    @property
    def seconds_left(self) -> float | None:
        """Until the limit, without what is kept back for saving and showing the scene; None without a limit."""
        if (most := self.limits.max_minutes) is None:
            return None
        return most * 60 - self.leaving_seconds - (time.monotonic() - self._began)

    @property
    def leaving_seconds(self) -> float:
        """What is kept back of a session's limit for saving and showing what stands."""
        most = self.limits.max_minutes
        return _LEAVING_SECONDS if most is None else min(_LEAVING_SECONDS, most * 6)

    def time_left(self, stage: Stage, attempt: int) -> str:
        """A sentence for the roles; "" in a run without a limit. A session that resumes, and a replay, say the same
        again.
        """
        if self.seconds_left is not None and self.options.origin != "replay":
            left = max(0, round(self.seconds_left / 60))
            self.journal.note(TimeTold(stage=stage, attempt=attempt, minutes=left))
        told = self.journal.find(TimeTold(stage=stage, attempt=attempt))
        return _TIME_LEFT.format(told.minutes) if told else ""

    # ToolSet

    def use(  # noqa: PLR0913, PLR0917 - who calls what with what
        self,
        role: str,
        stage: Stage,
        name: str,
        arguments: Mapping[str, Any],
        known: Mapping[str, Any] | None = None,
        moved: Mapping[str, str] | None = None,
    ) -> ToolOutcome:
        """Calls a tool, or takes what the journal has of this call.

        ``known`` are arguments that follow from the run, which ``arguments`` may replace. ``moved``: folders whose
        files go to another once the call is over; the answer has the paths at which they stay.
        """
        if self.is_leaving:
            return self._called(name, {**(known or {}), **arguments})
        with self._door:
            self._calls[role, stage] += 1
            number = self._calls[role, stage]
        about: dict[str, Any] = {"role": role, "stage": stage, "attempt": self.attempt, "n": number}
        asked = {**(known or {}), **arguments}
        if answered := self.journal.find(ToolAnswered(**about)):
            outcome = self._recalled(answered)
            self._remember(name, asked, outcome, answered.checkpoint)
            return outcome
        self.safe()
        self._align()
        self.journal.note(ToolCalled(**about, name=name, input=dict(arguments)))
        outcome, kept = self._seen.get(_call(name, asked)) or self._called(name, asked), None
        if not self.tools.is_read_only(name):
            outcome, kept = self._kept(outcome)
        self._remember(name, asked, outcome, kept)
        self.journal.note(
            ToolAnswered(
                **about,
                name=name,
                content=tuple(self._written(_renamed(block, moved)) for block in outcome.content),
                data=dict(outcome.data),
                failed=outcome.failed,
                seconds=round(outcome.seconds, 3),
                checkpoint=kept,
            )
        )
        return outcome

    def _remember(self, name: str, asked: Mapping[str, Any], outcome: ToolOutcome, kept: int | None) -> None:
        """Keeps what a call shows of the scene, for whoever asks the same while the scene is the same."""
        with self._door:
            if not self.tools.is_read_only(name):
                if kept is None or kept != self._checkpoint:
                    self._seen.clear()
                    self.is_changed = True
                self._checkpoint = kept
            elif not outcome.failed and name in _SHOWING:
                self._seen[_call(name, asked)] = replace(outcome, seconds=0.0)

    def keep_stills(self, outcome: ToolOutcome) -> None:
        """Keeps the pictures that the coder has rendered, the last few, for whoever judges its work."""
        made = (Still(outcome.text, picture, self._checkpoint) for picture in outcome.pictures)
        self.stills = [*self.stills, *made][-_KEPT_STILLS:]

    def is_current(self, still: Still) -> bool:
        """Whether the scene is still as a picture shows it."""
        return still.checkpoint == self._checkpoint

    def _kept(self, outcome: ToolOutcome) -> tuple[ToolOutcome, int | None]:
        """The checkpoint after a call. Where none can be taken, whoever called is told: the scene may be why."""
        try:
            return outcome, self.tools.checkpoint()
        except Stopping:
            raise
        except RunError as error:
            if not self.root.is_dir():
                raise  # no scene is why: the run's folder is gone
            text = f"{error} Until this is mended, what was changed is lost if Blender ends."
            return replace(outcome, content=(*outcome.content, Text(text)), failed=True), None

    def _called(self, name: str, arguments: Mapping[str, Any]) -> ToolOutcome:
        if name in self.tools.names:
            return self.tools.call(name, arguments, self.stop if name == RENDER else None)
        known = ", ".join(self.tools.names)
        return ToolOutcome((Text(f"There is no tool {name[:80]!r}; there are {known}."),), failed=True)

    def _align(self) -> None:
        """Before the first call of a session, puts Blender back to the checkpoint that the journal names last."""
        with self._door:
            if self._aligned:
                return
            wanted = self.journal.newest(ToolAnswered, SceneRestored, value=lambda event: event.checkpoint)
            if wanted is not None:
                now = self.tools.restore(wanted)
                if now != wanted:
                    self.journal.append(SceneRestored.model_validate({"from": wanted, "checkpoint": now}))
            self._aligned = True

    # Pictures: in the journal by name, on the disk by content

    def _written(self, block: Text | Picture) -> Text | PicturePart:
        if isinstance(block, Text):
            return block
        return PicturePart(path=self.keep(block), media_type=block.media_type)

    def keep(self, picture: Picture) -> str:
        """Saves a picture; its path in the run's folder."""
        name = f"pictures/{hashlib.sha256(picture.data).hexdigest()[:16]}.png"
        path = self.root / name
        try:
            if not path.exists():
                write_whole(path, picture.data, durable=False)
        except OSError as error:
            raise RunError(f"{path} cannot be written: {error.strerror or error}.") from error
        return name

    def picture(self, name: str) -> bytes:
        """A picture that was kept. Raises NoRun."""
        try:
            return (self.root / name).read_bytes()
        except OSError as error:
            raise NoRun(
                f"{error.filename}, a picture of an earlier answer, cannot be read: {error.strerror}."
            ) from error

    def _recalled(self, answered: ToolAnswered) -> ToolOutcome:
        """What a call came to. Raises NoRun."""
        if answered.content is None:
            raise NoRun(f"{self.journal.path}, row {answered.i}: not a valid 'tool.answered' row.")
        content = tuple(
            part if isinstance(part, Text) else Picture(self.picture(part.path), part.media_type)
            for part in answered.content
        )
        return ToolOutcome(content, answered.data, answered.failed, answered.seconds or 0.0)

    # The scene

    def state(self, stage: Stage) -> str:
        """The scene's readout; in an edit, what the instruction names comes first, and once there is a plan, only what
        it is about is told in full.
        """
        if self.task is not None:
            asked, known = self.task.readout()
        else:
            first = words_of(self.options.prompt)[:_MOST_WORDS] if self.options.mode == "edit" else []
            asked, known = ({"first": first} if first else {}), {}
        return self.use(RUNNER, stage, "blender_scene_state", asked, known).text

    def save(self, stage: Stage, name: str) -> Path:
        """Saves the scene as the checkpoint ``name``, with its caches beside it. Raises NotSaved.

        A new scene renders as its plan says from then on, whatever engine, size and samples its coder has left.
        """
        target = self.checkpoints / f"{name}.blend"
        if self.task is not None and self.task.plan is not None:
            planned = self.task.plan.render
            code = code_of(planned, self.samples or planned.samples)
            self.use(planner.NAME, stage, "blender_execute", {"code": code})
        self._save(stage, name, target, self.root / "blender" / target.name, is_replaced=False)
        return target

    def deliver(self, stage: Stage, *, verify: bool = False) -> Path:
        """Saves the scene as the run's result so far, in place of an earlier one. Raises NotSaved."""
        target = self.root / SCENE
        made = self.root / "blender" / "delivered" / stage / SCENE
        self._save(stage, f"delivered/{stage}/{target.stem}", target, made, verify=verify)
        return target

    def _save(  # noqa: PLR0913 - what is saved, from where to where
        self,
        stage: Stage,
        name: str,
        target: Path,
        made: Path,
        *,
        verify: bool = False,
        is_replaced: bool = True,
    ) -> None:
        """Lets the tool save ``made``, and moves it to ``target``, unless an earlier session has."""
        moved = {str(made.parent): str(target.parent)}
        outcome = self.use(RUNNER, stage, "blender_save", {"name": name, "verify": verify}, moved=moved)
        for unused in outcome.data.get("unused", ()):
            self._unused.setdefault(unused, name != START)
        if made.is_file() and (is_replaced or not target.exists()):
            try:
                move_saved(made, target)
            except OSError as error:
                raise NotSaved(f"{target} cannot be written: {error.strerror or error}.") from error
        if not target.is_file() or "path" not in outcome.data:  # an earlier scene may stand there
            raise NotSaved(f"The scene could not be saved: {outcome.text}")

    def unused_since(self) -> str:
        """What the last saves have left out for want of a user, each named once; "" if that is nothing new.

        What the run began with counts as told.
        """
        news = [name for name, is_news in self._unused.items() if is_news]
        self._unused.update(dict.fromkeys(news, False))
        return _UNUSED.format(format_list(news, _LISTED)) if news else ""

    def load(self, stage: Stage, file: Path) -> None:
        """Opens a .blend in place of the scene. Raises RunError."""
        outcome = self.use(RUNNER, stage, "blender_load", {"path": str(file)})
        if outcome.failed:
            raise RunError(f"{file} cannot be opened: {outcome.text}")

    def roll_back(self, stage: Stage, attempt: int, to: str) -> None:
        """Puts the scene back to a closed stage, or to the START, and journals that."""
        self.load(stage, self.checkpoints / f"{to}.blend")
        self.journal.note(RolledBack(stage=stage, attempt=attempt, to=to))

    def attempted(self, stage: Stage, attempt: int, code: Callable[[], WorkResult]) -> WorkResult:
        """Lets a coder work, and journals the beginning and end of the attempt."""
        self.attempt = attempt
        self.stills.clear()
        about: dict[str, Any] = {"stage": stage, "attempt": attempt}
        self.journal.note(AttemptBegan(**about))
        worked = code()
        self.journal.note(AttemptEnded(**about, report=worked.said, ended=worked.how, calls=worked.calls))
        return worked

    # Files

    def write(self, name: str, text: str) -> Path:
        """Writes a file atomically into the run's folder. Raises RunError."""
        path = self.root / name
        try:
            write_whole(path, text, durable=False)
        except OSError as error:
            raise RunError(f"{path} cannot be written: {error.strerror or error}.") from error
        return path


class RoleTools:
    """The tools of one role in one stage: the coder has all, the reviewer those that only read (paper, "Agents").

    The coder is told of those that its stage needs.
    """

    def __init__(self, run: Run, role: str, stage: Stage) -> None:
        self._run = run
        self._role = role
        self._stage: Stage = stage
        self._names: Sequence[str] = ()
        if role == coder.NAME:
            # blender_execute checks the coder's code by itself; files of other programs are for clients with users.
            without = (CHECK, *_EXCHANGE, *(() if run.options.verifier else (VERIFY,)))
            self._names = [name for name in run.tools.names if name not in without]
        elif role == reviewer.NAME:
            self._names = [name for name in run.tools.names if name in _LOOKS]

    @property
    def offered(self) -> tuple[Tool, ...]:
        """What the model is told of them."""
        is_told = coder.is_needed if self._role == coder.NAME else coder.is_seen
        staged = self._run.options.stages
        return self._run.tools.offered(
            [name for name in self._names if is_told(name, self._stage, staged=staged)]
        )

    def use(self, call: ToolUse) -> ToolResult:
        """Calls one, for the model."""
        if call.name not in self._names and call.name in self._run.tools.names:
            text = f"{call.name} is not available to your role; you have {', '.join(self._names)}."
            return ToolResult(call.id, (Text(text),), failed=True)
        task = self._run.task if call.name == VERIFY else None
        known = task.verification(self._stage) if task else None
        outcome = self._run.use(self._role, self._stage, call.name, call.input, known)
        if self._role == coder.NAME and call.name == RENDER and not outcome.failed:
            self._run.keep_stills(outcome)
        if task is not None and "findings" in outcome.data:
            findings, text = told_since(task.known, outcome)
            _, withdrawn = as_soft(findings, self._run.withdrawn)
            if withdrawn:
                text = f"{withdrawn}\n{text}"
            if withdrawn or task.known:
                return ToolResult(call.id, (Text(text), *(outcome.pictures if findings else ())))
        return ToolResult(call.id, outcome.content, outcome.failed)


def _call(name: str, asked: Mapping[str, Any]) -> str:
    return json.dumps([name, asked], sort_keys=True, default=str)


def _renamed(block: Text | Picture, moved: Mapping[str, str] | None) -> Text | Picture:
    if isinstance(block, Picture) or not moved:
        return block
    text = block.text
    for here, there in moved.items():
        text = text.replace(here, there)
    return Text(text)


def plan_file(value: Any) -> str:
    """A plan as it is written to ``plan.json``."""
    return json.dumps(value.model_dump(mode="json"), indent=2, ensure_ascii=False) + "\n"
