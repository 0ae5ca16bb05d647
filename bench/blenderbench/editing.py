"""SimWorlds' edit mode as a system: the command itself, in a process of its own, taken up again where it was killed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from agents.loop.errors import RunError
from agents.loop.journal import NAME as JOURNAL
from agents.loop.reducer import read_run_state
from agents.loop.stage import MAX_REPLANS_PER_STAGE, MAX_RETRIES_PER_STAGE
from bench.blenderbench.errors import NotDone, NotReady
from bench.blenderbench.making import Made, begun
from bench.blenderbench.results import round_file
from bench.blenderbench.task_scenes import Look, render
from bench.sweep.command import called, last_words
from bench.sweep.systems.simworlds_runs import KEYS

if TYPE_CHECKING:
    from pathlib import Path

    from agents.loop.run_state import RunState
    from bench.blenderbench.making import Tell
    from bench.blenderbench.results import Place
    from bench.blenderbench.task_set import Task

Reference = Literal["goal", "visprompt"]
BUDGET = (
    f"SimWorlds' own: {MAX_RETRIES_PER_STAGE} retries and {MAX_REPLANS_PER_STAGE} replans a stage (the paper compares "
    "at 6 iterations)"
)
_ENDED = ("done", "aborted")
_LOG = "edit.log"


@dataclass(frozen=True, slots=True)
class SimWorlds:
    """``simworlds edit`` with the instruction and the goal; its scene, rendered. One round: the finished scene.

    ``reference``: which picture it is given; where a task has no visprompt, the goal. ``options``: further ones of
    the command, as of its model; ``limits``: of one session at it.
    """

    look: Look
    reference: Reference = "goal"
    options: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    kind: str = "simworlds"
    name: str = "SimWorlds"
    takes_over: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """All that the result depends on."""
        told = {"samples": self.look.samples, "reference": self.reference, "options": list(self.options)}
        return {**told, "budget": BUDGET}

    def make(self, task: Task, place: Place, tell: Tell) -> Made:
        """Edits, or goes on with an edit that was broken off; renders what came of it."""
        before = _run_state(place)
        ended = before is not None and before.outcome in _ENDED
        if not ended and not any(os.environ.get(name) for name in KEYS):
            raise NotReady(f"'simworlds edit' asks a language model and needs a key: set {KEYS[0]}.")
        started, loss = begun(task, place, self.look, tell)
        if not ended:
            tell("editing")
            self._run(task, place)
        run_state = _run_state(place)
        if run_state is None:
            raise NotDone(f"the edit did not begin: {last_words(place.root / _LOG)}")
        file, notes = _result(run_state, place)
        tell("rendering the result")
        rendered = render(file, place.root / round_file(1), task.size, self.look)
        if rendered.camera != started.rendered.camera:
            notes += (f"seen by {rendered.camera!r}, not by {started.rendered.camera!r} as the start was",)
        total = run_state.total
        cost = None if total.unpriced else total.cost
        notes = (*started.notes, *notes)
        return Made((round_file(1),), loss, rendered, dict(run_state.models), cost, notes)

    def _run(self, task: Task, place: Place) -> None:
        given = task.visprompt if self.reference == "visprompt" and task.visprompt else task.goal
        if (place.edit / JOURNAL).exists():
            words = ["resume", *self.limits, "--quiet", "--", str(place.edit)]
        else:
            look = ["--reference", str(given), "--samples", str(self.look.samples)]
            words = ["edit", "--run", str(place.edit), *look, *self.options, *self.limits, "--quiet"]
            words += ["--", str(place.start), task.instruction]
        called(words, place.root / _LOG)


def _run_state(place: Place) -> RunState | None:
    """What the journal of the edit tells; None where none was begun."""
    try:
        return read_run_state(place.edit)
    except RunError:
        return None


def _result(run_state: RunState, place: Place) -> tuple[Path, tuple[str, ...]]:
    """The scene that counts, and what is to be said of it. Raises NotDone where there is none."""
    ending = run_state.ending
    if ending is None:
        raise NotDone(f"the edit was broken off: {last_words(place.root / _LOG)}")
    file = place.edit / ending.file if ending.file else None
    if ending.outcome == "done" and file is not None and file.is_file():
        return file, ()
    if ending.outcome == "aborted" and file is not None and file.is_file():
        return file, (f"the edit was aborted, and the last stage that was closed counts: {ending.why}",)
    raise NotDone(f"the edit {ending.outcome}: {ending.why}")
