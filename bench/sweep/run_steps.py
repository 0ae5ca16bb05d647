"""Runs the steps of one scene that are due: produce, audit, frames.

A step is due when the key of its inputs is not that of its last result, or when it has no result. The record is written
after each step, whole or not at all: a sweep that was killed goes on where it was, and rescoring is the same without
the first step.
"""

from __future__ import annotations

import time
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from bench.sweep.provenance import provenance
from bench.sweep.records import SceneRecord, read_record, write_record
from bench.sweep.steps import STEPS
from simworlds.sandbox.errors import BlenderError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.sweep.scene_task import SceneTask, Tell
    from bench.sweep.steps import DueStep, ScoringStep


def do_scene(task: SceneTask, tell: Tell) -> SceneRecord:
    """Runs the steps that are due. Returns the record, as it is on the disk then.

    Raises BadSceneRecord, OSError, BlenderError where no Blender works here.
    """
    record = read_record(task.folder) or SceneRecord(scene=task.spec.id, system=task.system.info)
    for step in _steps(task):
        due = step.due(task, record)
        if due is not None:
            began = time.monotonic()
            result = step.do(task, record, due, tell)
            part = step.part(**step_fields(due, began), **result)
            record = record.model_copy(update={"system": task.system.info, step.field: part})
            write_record(task.folder, record)
    return record


def is_done(task: SceneTask) -> bool:
    """Whether no step is due, as far as this machine can tell. Raises BadSceneRecord, OSError."""
    record = read_record(task.folder)
    try:
        return record is not None and all(step.due(task, record) is None for step in _steps(task))
    except BlenderError:  # none on this machine; there may be one where the task runs
        return False


def _steps(task: SceneTask) -> Iterator[ScoringStep]:
    return (step for name, step in STEPS.items() if name in task.steps)


def step_fields(due: DueStep, began: float) -> dict[str, Any]:
    """The fields that every part of a record has; ``began``: on the monotonic clock."""
    return {
        "key": due.key,
        "at": datetime.now(UTC).isoformat(timespec="seconds"),
        "seconds": round(time.monotonic() - began, 3),
        "provenance": provenance(due.code, due.blender),
    }
