"""SimWorlds' edit mode as a system: runs the command ``simworlds edit``, and resumes a run that was killed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from agents.loop.errors import RunError
from agents.loop.record.journal import NAME as JOURNAL
from agents.loop.record.reducer import read_run_state
from agents.loop.stage import MAX_REPLANS_PER_STAGE, MAX_RETRIES_PER_STAGE
from bench.blenderbench.edit_system import EditOutput, prepare_start
from bench.blenderbench.errors import EditSystemNotReady, TaskFailed
from bench.blenderbench.results import round_file
from bench.blenderbench.task_scenes import EditRenderSettings, render
from bench.sweep.command import last_output, run_simworlds

if TYPE_CHECKING:
    from pathlib import Path

    from agents.loop.record.run_state import RunState
    from bench.blenderbench.edit_system import Tell
    from bench.blenderbench.results import TaskFolder
    from bench.blenderbench.task_set import BenchTask

Reference = Literal["goal", "visprompt"]
BUDGET = (
    f"SimWorlds' own: {MAX_RETRIES_PER_STAGE} retries and {MAX_REPLANS_PER_STAGE} replans a stage (the paper compares "
    "at 6 iterations)"
)
_KEYS = ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN")
_ENDED = ("done", "aborted")
_LOG = "edit.log"


@dataclass(frozen=True, slots=True)
class SimWorldsEdit:
    """Runs ``simworlds edit`` with instruction and goal, and renders the finished scene: one round.

    ``reference``: the picture that it gets; the goal where a task has no visprompt. ``options``: further options of
    the command, such as its model; ``limits``: of one session.
    """

    rendering: EditRenderSettings
    reference: Reference = "goal"
    options: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    kind: str = "simworlds"
    name: str = "SimWorlds"
    takes_over: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """Everything that the result depends on."""
        settings = {
            "samples": self.rendering.samples,
            "reference": self.reference,
            "options": list(self.options),
        }
        return {**settings, "budget": BUDGET}

    def make(self, task: BenchTask, place: TaskFolder, tell: Tell) -> EditOutput:
        """Edits, or resumes an interrupted edit; renders the result."""
        before = _history(place)
        ended = before is not None and before.outcome in _ENDED
        if not ended and not any(os.environ.get(name) for name in _KEYS):
            raise EditSystemNotReady(
                f"'simworlds edit' asks a language model and needs a key: set {_KEYS[0]}."
            )
        started, loss = prepare_start(task, place, self.rendering, tell)
        if not ended:
            tell("editing")
            self._run(task, place)
        history = _history(place)
        if history is None:
            raise TaskFailed(f"the edit did not start: {last_output(place.root / _LOG)}")
        file, notes = _result(history, place)
        tell("rendering the result")
        rendered = render(file, place.root / round_file(1), task.size, self.rendering)
        if rendered.camera != started.rendered.camera:
            notes += (
                f"rendered through {rendered.camera!r}; the start was rendered through {started.rendered.camera!r}",
            )
        total = history.total
        cost = None if total.unpriced else total.cost
        notes = (*started.notes, *notes)
        return EditOutput((round_file(1),), loss, rendered, dict(history.models), cost, notes)

    def _run(self, task: BenchTask, place: TaskFolder) -> None:
        reference = task.visprompt if self.reference == "visprompt" and task.visprompt else task.goal
        if (place.edit / JOURNAL).exists():
            words = ["resume", *self.limits, "--quiet", "--", str(place.edit)]
        else:
            picture = ["--reference", str(reference), "--samples", str(self.rendering.samples)]
            words = ["edit", "--run", str(place.edit), *picture, *self.options, *self.limits, "--quiet"]
            words += ["--", str(place.start), task.instruction]
        run_simworlds(words, place.root / _LOG)


def _history(place: TaskFolder) -> RunState | None:
    """The state of the edit's run by its journal; None if there is none."""
    try:
        return read_run_state(place.edit)
    except RunError:
        return None


def _result(history: RunState, place: TaskFolder) -> tuple[Path, tuple[str, ...]]:
    """The scene that counts, and notes on it. Raises TaskFailed where there is none."""
    ending = history.ending
    if ending is None:
        raise TaskFailed(f"the edit was interrupted: {last_output(place.root / _LOG)}")
    file = place.edit / ending.file if ending.file else None
    if ending.outcome == "done" and file is not None and file.is_file():
        return file, ()
    if ending.outcome == "aborted" and file is not None and file.is_file():
        return file, (f"the edit was aborted; the last finished stage counts: {ending.why}",)
    raise TaskFailed(f"the edit {ending.outcome}: {ending.why}")
