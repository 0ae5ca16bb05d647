"""A run: what the loop works with, and what it does to the scene."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from agents.blender.files.saved_files import move_saved
from agents.blender.tools.scene_order import words_of
from agents.loop.edit.baseline import told_since
from agents.loop.errors import NotSaved, RunError
from agents.loop.film.planned_settings import code_of
from agents.loop.film.telling_frames import MeasuredMotion
from agents.loop.record.events import AttemptBegan, AttemptEnded, RolledBack, TimeTold
from agents.loop.review.acceptance import AcceptanceRecord
from agents.loop.review.withdrawals import as_soft
from agents.loop.running.interruptible import Interruptible
from agents.loop.running.position import START, Position
from agents.loop.running.run_tools import LOOKS, RENDER, RUNNER, TRIAL, VERIFY
from agents.loop.running.unused_blocks import UnusedBlocks
from agents.roles import coder, planner, reviewer
from agents.roles.base import RoleContext
from simworlds.llm.messages import Picture, Text, ToolResult

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from agents.loop.film.film_limits import FilmLimits
    from agents.loop.options import Options
    from agents.loop.record.journal import Journal
    from agents.loop.running.deadline import Deadline
    from agents.loop.running.run_files import RunFiles
    from agents.loop.running.run_tools import RunTools
    from agents.loop.running.tool_client import ToolOutcome
    from agents.loop.task import RunTask
    from agents.plan.part import Stage
    from agents.plan.tactical import Withdrawal
    from agents.roles.base import WorkResult
    from simworlds.llm.messages import Model, Tool, ToolUse

_CHECK = "blender_check"
_EXCHANGE = ("blender_import", "blender_export")
_KEPT_STILLS = 2
_TIME_LEFT = "About {} minutes are left; then the run ends with what stands."
_MOST_WORDS = 60  # of an instruction


@dataclass(frozen=True, slots=True)
class Still:
    """A picture that was rendered, with what the tool said of it, and the checkpoint of its scene."""

    text: str
    picture: Picture
    checkpoint: int | None


@dataclass
class Run:
    """What the loop works with. Two threads may use its tools at the same time.

    ``saying`` gets a role and the next words of its model. ``task``: what the run is held to, once there is a plan;
    ``acceptance``: what the plans of the closed stages wanted, and whether it holds; ``withdrawn``: what of the plan no
    longer counts. ``motion``: what the motion stage's reviewer was shown of it. ``stills``: the last pictures that the
    coder rendered in this attempt.
    """

    options: Options
    film_limits: FilmLimits
    deadline: Deadline
    files: RunFiles
    journal: Journal
    tools: RunTools
    model: Model
    saying: Callable[[str, str], object]
    position: Position
    task: RunTask | None = None
    acceptance: AcceptanceRecord = field(default_factory=AcceptanceRecord)
    withdrawn: list[Withdrawal] = field(default_factory=list["Withdrawal"])
    motion: MeasuredMotion = field(default_factory=MeasuredMotion)
    stills: list[Still] = field(default_factory=list["Still"])
    unused: UnusedBlocks = field(default_factory=UnusedBlocks)

    @cached_property
    def context(self) -> RoleContext:
        """What the roles work with."""
        return RoleContext(
            Interruptible(self.model, self.deadline.asked),
            self.options.model,
            tools=lambda role, stage: RoleTools(self, role, stage),
            saying=self.saying,
            safe=self.deadline.check,
            names=self.options.models,
            verifier=self.options.verifier,
            staged=self.options.stages,
        )

    def time_left(self, stage: Stage, attempt: int) -> str:
        """A sentence for the roles; "" in a run without a limit. A session that resumes, and a replay, say the same
        again.
        """
        seconds = self.deadline.seconds_left
        if seconds is not None and self.options.origin != "replay":
            left = max(0, round(seconds / 60))
            self.journal.note(TimeTold(stage=stage, attempt=attempt, minutes=left))
        told = self.journal.find(TimeTold(stage=stage, attempt=attempt))
        return _TIME_LEFT.format(told.minutes) if told else ""

    # What is seen of the scene

    def state(self, stage: Stage) -> str:
        """The scene's readout; in an edit, what the instruction names comes first, and once there is a plan, only what
        it is about is told in full.
        """
        if self.task is not None:
            asked, known = self.task.readout()
        else:
            first = words_of(self.options.prompt)[:_MOST_WORDS] if self.options.mode == "edit" else []
            asked, known = ({"first": first} if first else {}), {}
        return self.tools.use(RUNNER, stage, "blender_scene_state", asked, known).text

    def keep_stills(self, outcome: ToolOutcome) -> None:
        """Keeps the pictures that the coder has rendered, the last few, for whoever judges its work."""
        made = (Still(outcome.text, picture, self.tools.checkpoint) for picture in outcome.pictures)
        self.stills = [*self.stills, *made][-_KEPT_STILLS:]

    def is_current(self, still: Still) -> bool:
        """Whether the scene is still as a picture shows it."""
        return still.checkpoint == self.tools.checkpoint

    # The scene's files

    def save(self, stage: Stage, name: str) -> None:
        """Saves the scene as the checkpoint ``name``, with its caches beside it. Raises NotSaved.

        A new scene renders as its plan says from then on, whatever engine, size and samples its coder has left.
        """
        if self.task is not None and self.task.plan is not None:
            planned = self.task.plan.render
            code = code_of(planned, self.film_limits.samples or planned.samples)
            self.tools.use(planner.NAME, stage, "blender_execute", {"code": code})
        target = self.files.checkpoint(name)
        self._save(stage, name, target, self.files.of_blender / target.name, is_replaced=False)

    def deliver(self, stage: Stage, *, verify: bool = False) -> None:
        """Saves the scene as the run's result so far, in place of an earlier one. Raises NotSaved."""
        target = self.files.scene
        made = self.files.of_blender / "delivered" / stage / target.name
        self._save(stage, f"delivered/{stage}/{target.stem}", target, made, verify=verify)
        for emptied in (made.parent, made.parent.parent):
            with suppress(OSError):  # not there, or something was left behind in it
                emptied.rmdir()

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
        outcome = self.tools.use(RUNNER, stage, "blender_save", {"name": name, "verify": verify}, moved=moved)
        self.unused.add(outcome.data.get("unused", ()), is_news=name != START)
        if made.is_file() and (is_replaced or not target.exists()):
            try:
                move_saved(made, target)
            except OSError as error:
                raise NotSaved(f"{target} cannot be written: {error.strerror or error}.") from error
        if not target.is_file() or "path" not in outcome.data:  # an earlier scene may stand there
            raise NotSaved(f"The scene could not be saved: {outcome.text}")

    def load(self, stage: Stage, file: Path) -> None:
        """Opens a .blend in place of the scene. Raises RunError."""
        outcome = self.tools.use(RUNNER, stage, "blender_load", {"path": str(file)})
        if outcome.failed:
            raise RunError(f"{file} cannot be opened: {outcome.text}")

    def roll_back(self, stage: Stage, attempt: int, to: str) -> None:
        """Puts the scene back to a closed stage, or to the START, and journals that."""
        self.load(stage, self.files.checkpoint(to))
        self.journal.note(RolledBack(stage=stage, attempt=attempt, to=to))

    def attempted(self, stage: Stage, attempt: int, code: Callable[[], WorkResult]) -> WorkResult:
        """Lets a coder work, and journals the beginning and end of the attempt."""
        self.position.attempt = attempt
        self.stills.clear()
        about: dict[str, Any] = {"stage": stage, "attempt": attempt}
        self.journal.note(AttemptBegan(**about))
        worked = code()
        self.journal.note(AttemptEnded(**about, report=worked.said, ended=worked.how, calls=worked.calls))
        return worked


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
            without = (_CHECK, *_EXCHANGE, *(() if run.options.verifier else (VERIFY,)))
            self._names = [name for name in run.tools.client.names if name not in without]
        elif role == reviewer.NAME:
            self._names = [name for name in run.tools.client.names if name in LOOKS]

    @property
    def offered(self) -> tuple[Tool, ...]:
        """What the model is told of them."""
        is_told = coder.is_needed if self._role == coder.NAME else coder.is_seen
        staged = self._run.options.stages
        return self._run.tools.client.offered(
            [name for name in self._names if is_told(name, self._stage, staged=staged)]
        )

    def use(self, call: ToolUse) -> ToolResult:
        """Calls one, for the model."""
        if call.name not in self._names and call.name in self._run.tools.client.names:
            text = f"{call.name} is not available to your role; you have {', '.join(self._names)}."
            return ToolResult(call.id, (Text(text),), failed=True)
        task = self._run.task if call.name == VERIFY else None
        outcome = self._run.tools.use(self._role, self._stage, call.name, call.input, self._known(call.name))
        if self._role == coder.NAME and call.name == RENDER and not outcome.failed:
            self._run.keep_stills(outcome)
        if task is not None and "findings" in outcome.data:
            # The stage is held to these too: whoever builds it is to know before it ends.
            off_plan = task.off_plan(self._stage) if task.off_plan and "rules" not in call.input else ()
            findings, text = told_since(task.known, outcome, off_plan)
            _, withdrawn = as_soft(findings, self._run.withdrawn)
            if withdrawn:
                text = f"{withdrawn}\n{text}"
            if withdrawn or off_plan or task.known:
                return ToolResult(call.id, (Text(text), *(outcome.pictures if findings else ())))
        return ToolResult(call.id, outcome.content, outcome.failed)

    def _known(self, tool: str) -> dict[str, Any] | None:
        """The arguments of a tool that follow from what the run is held to."""
        task = self._run.task
        if task is None:
            return None
        if tool == VERIFY:
            return task.verification(self._stage)
        return task.trial if tool == TRIAL else None
