"""Runs a system on tasks. Each record is kept as soon as its task has ended, so that a killed run can go on."""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING

from pydantic import ValidationError

from bench.blenderbench.edit_system import EditOutput
from bench.blenderbench.errors import BadResults, TaskFailed
from bench.blenderbench.results import RunSetup, SetRun, TaskRecord, read, read_run, task_folder, write
from bench.sweep.content_hash import digests
from bench.sweep.provenance import IN_BLENDER, code_of, provenance
from simworlds.folder_lock import locked
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from bench.blenderbench.edit_system import EditSystem
    from bench.blenderbench.results import TaskFolder
    from bench.blenderbench.task_set import BenchTask, TaskSet
    from bench.sweep.records import Provenance


def run(  # noqa: PLR0913
    task_set: TaskSet,
    tasks: Sequence[BenchTask],
    system: EditSystem,
    out: Path,
    *,
    name: str = "",
    tell: Callable[[str], object] = lambda _: None,
) -> list[TaskRecord]:
    """Lets a system edit tasks; returns their records. Finished tasks are not run again.

    Failed tasks are tried once more. ``name``: of the system in tables. ``tell`` is called with the progress. Raises
    BadResults for a folder of other content, EditSystemNotReady for a system that cannot run,
    CannotStart where no Blender works, OSError where nothing can be written.
    """
    called = {"name": name or system.name, "system": system.kind, "set": str(task_set.root)}
    try:
        setup = RunSetup(**called, settings=system.settings)
    except ValidationError as error:
        raise BadResults(
            f"{called['name']!r} cannot be a name in tables: use at most 40 letters, digits, spaces and ._+- (--name)."
        ) from error
    try:
        out.mkdir(parents=True, exist_ok=True)
        with locked(out):
            _begin(task_set, setup, out)
            return [_kept(task, system, out, tell) for task in tasks]
    except Refusal as error:
        raise BadResults(str(error)) from error


def _begin(task_set: TaskSet, setup: RunSetup, out: Path) -> None:
    """Writes ``run.json``; the setup must be the same as before."""
    if (out / "run.json").exists():
        before = read_run(out).setup
        if before != setup:
            raise BadResults(
                f"{out} holds results of another setup: {before.model_dump_json()}, now {setup.model_dump_json()}. "
                "Choose another folder."
            )
    elif any(path.name != ".lock" for path in out.iterdir()):
        raise BadResults(f"{out} is not empty and has no results. Choose another folder.")
    ids = tuple(task.id for task in task_set.tasks)
    write(out / "run.json", SetRun(setup=setup, tasks=ids, faults=task_set.faults, provenance=_provenance()))


def _kept(task: BenchTask, system: EditSystem, out: Path, tell: Callable[[str], object]) -> TaskRecord:
    """The record of a task: the kept one, or a new one."""
    place = task_folder(out, task.id)
    inputs = digests(task.folder, _files(task))
    if place.record.is_file():
        record = read(place.record, TaskRecord)
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


def _files(task: BenchTask) -> list[Path]:
    """The files that a task consists of."""
    return [task.blend, task.folder / "start.py", task.folder / "task.txt", task.goal]


def _clear(place: TaskFolder) -> None:
    """Removes the files of a failed attempt. An edit stays: it may be resumed."""
    for path in (place.record, place.scores):
        path.unlink(missing_ok=True)
    shutil.rmtree(place.renders, ignore_errors=True)


def _done(
    task: BenchTask,
    inputs: dict[str, str],
    system: EditSystem,
    place: TaskFolder,
    tell: Callable[[str], object],
) -> TaskRecord:
    place.renders.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(task.goal, place.goal)
    began = time.monotonic()
    why: str | None = None
    try:
        output = system.make(task, place, tell)
    except TaskFailed as error:
        output, why = EditOutput((), cost=None), str(error)
    return TaskRecord(
        task=task.id,
        level=task.level,
        instruction=task.instruction,
        why=why,
        rounds=output.rounds,
        start_loss=output.start_loss,
        rendered=output.rendered,
        models=output.models,
        cost=output.cost,
        seconds=round(time.monotonic() - began, 3),
        notes=output.notes,
        inputs=inputs,
        provenance=_provenance(output.rendered.blender if output.rendered else None),
    )


def _provenance(blender: str | None = None) -> Provenance:
    return provenance(
        code_of(__name__, "bench/blenderbench/inside/*.py", "bench/audit/inside/*.py", IN_BLENDER), blender
    )
