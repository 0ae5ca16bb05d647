"""Runs a system on tasks: a record of each, kept as soon as it is done, so that a run that was killed goes on."""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING

from pydantic import ValidationError

from bench.blenderbench.errors import BadResults, NotDone
from bench.blenderbench.making import Made
from bench.blenderbench.results import Record, Run, Setup, place_of, read, read_run, write
from bench.sweep.content_hash import digests
from bench.sweep.provenance import code_of, provenance
from simworlds.folder_lock import locked
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from bench.blenderbench.making import System
    from bench.blenderbench.results import Place
    from bench.blenderbench.task_set import Task, TaskSet
    from bench.sweep.records import Provenance


def run(  # noqa: PLR0913
    found: TaskSet,
    tasks: Sequence[Task],
    system: System,
    out: Path,
    *,
    name: str = "",
    tell: Callable[[str], object] = lambda _: None,
) -> list[Record]:
    """Has a system edit tasks; returns their records. What is done already is not done again.

    Tasks that came to nothing are tried once more. ``name``: what the system is called in tables. ``tell`` hears what
    is being done. Raises BadResults for a folder that holds something else, NotReady for a system that cannot be run,
    CannotStart where no Blender works, OSError where nothing can be written.
    """
    called = {"name": name or system.name, "system": system.kind, "set": str(found.root)}
    try:
        setup = Setup(**called, settings=system.settings)
    except ValidationError as error:
        raise BadResults(
            f"{called['name']!r} cannot stand in a table: give 40 letters, digits, spaces and ._+- at most (--name)."
        ) from error
    try:
        out.mkdir(parents=True, exist_ok=True)
        with locked(out):
            _begin(found, setup, out)
            return [_kept(task, system, out, tell) for task in tasks]
    except Refusal as error:
        raise BadResults(str(error)) from error


def _begin(found: TaskSet, setup: Setup, out: Path) -> None:
    """Writes down what the folder is made by, which has to be the same as before."""
    if (out / "run.json").exists():
        before = read_run(out).setup
        if before != setup:
            raise BadResults(
                f"{out} holds results of {before.model_dump_json()}, and these would be of {setup.model_dump_json()}. "
                "Choose another folder."
            )
    elif any(path.name != ".lock" for path in out.iterdir()):
        raise BadResults(f"{out} is not empty, and holds no results. Choose another folder.")
    ids = tuple(task.id for task in found.tasks)
    write(out / "run.json", Run(setup=setup, tasks=ids, faults=found.faults, provenance=_provenance()))


def _kept(task: Task, system: System, out: Path, tell: Callable[[str], object]) -> Record:
    """The record of a task, from before or made now."""
    place = place_of(out, task.id)
    inputs = digests(task.folder, _files(task))
    if place.record.is_file():
        record = read(place.record, Record)
        if record.inputs != inputs:
            raise BadResults(
                f"{task.folder} has changed since {place.record} was made. Choose another folder."
            )
        if record.why is None and not system.takes_over:
            return record
        _clear(place)
    record = _done(task, inputs, system, place, lambda doing: tell(f"{task.id}: {doing}"))
    write(place.record, record)
    return record


def _files(task: Task) -> list[Path]:
    """What a task is."""
    return [task.blend, task.folder / "start.py", task.folder / "task.txt", task.goal]


def _clear(place: Place) -> None:
    """Removes what a try left that came to nothing. An edit stays: it may be gone on with."""
    for path in (place.record, place.scores):
        path.unlink(missing_ok=True)
    shutil.rmtree(place.renders, ignore_errors=True)


def _done(
    task: Task, inputs: dict[str, str], system: System, place: Place, tell: Callable[[str], object]
) -> Record:
    place.renders.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(task.goal, place.goal)
    began = time.monotonic()
    why: str | None = None
    try:
        made = system.make(task, place, tell)
    except NotDone as error:
        made, why = Made((), cost=None), str(error)
    return Record(
        task=task.id,
        level=task.level,
        instruction=task.instruction,
        why=why,
        rounds=made.rounds,
        start_loss=made.start_loss,
        rendered=made.rendered,
        models=made.models,
        cost=made.cost,
        seconds=round(time.monotonic() - began, 3),
        notes=made.notes,
        inputs=inputs,
        provenance=_provenance(made.rendered.blender if made.rendered else None),
    )


def _provenance(blender: str | None = None) -> Provenance:
    return provenance(code_of(__name__, "blenderbench/inside/*.py", "audit/inside/opening.py"), blender)
