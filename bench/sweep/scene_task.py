"""One scene by one system, step by step: produced, audited, framed. What is done already is not done again.

A step is due when the key of its inputs is another than that of its last result, or when it had none. The record is
written after each, whole or not at all; so a sweep that is killed goes on where it was, and to score anew is to do the
same without the first step.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, TypeAlias

from bench.audit.untrusted_blend import BlenderOptions
from bench.frames.clip_frames import RenderQuality
from bench.sweep.provenance import provenance
from bench.sweep.records import Record, read_record, write_record
from bench.sweep.steps import STEPS
from simworlds.sandbox.errors import BlenderError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.sweep.records import File
    from bench.sweep.steps import Due, Step
    from bench.sweep.systems.system import System

    Tell: TypeAlias = Callable[[str], None]


@dataclass(frozen=True)
class Task:
    """What is to be done for one scene. Plain data: it is sent to other processes, on other machines too.

    ``folder`` is the scene's in the results. ``steps``: names of those that may be done. ``from_video``: frames are
    those of the system's own video, where it brought one.
    """

    spec: Spec
    system: System
    folder: Path
    means: BlenderOptions = field(default_factory=BlenderOptions)
    look: RenderQuality = field(default_factory=RenderQuality)
    steps: tuple[str, ...] = tuple(STEPS)
    from_video: bool = True

    @property
    def is_static(self) -> bool:
        """Whether one frame shows all."""
        return self.spec.category == "static"

    def path(self, file: File) -> Path:
        """Where a file of the record lies."""
        return ((self.system.source if file.source else None) or self.folder) / file.path


def do_scene(task: Task, tell: Tell) -> Record:
    """Does the steps that are due; the record, as it is on the disk then.

    Raises BadRecord, OSError, BlenderError where no Blender works here.
    """
    record = read_record(task.folder) or Record(scene=task.spec.id, system=task.system.info)
    for step in _steps(task):
        due = step.due(task, record)
        if due is not None:
            began = time.monotonic()
            result = step.do(task, record, due, tell)
            part = step.part(**stamp(due, began), **result)
            record = record.model_copy(update={"system": task.system.info, step.field: part})
            write_record(task.folder, record)
    return record


def is_done(task: Task) -> bool:
    """Whether nothing is due, as far as that can be known here. Raises BadRecord, OSError."""
    record = read_record(task.folder)
    try:
        return record is not None and all(step.due(task, record) is None for step in _steps(task))
    except BlenderError:  # there is none here; there may be one where the task is done
        return False


def _steps(task: Task) -> Iterator[Step]:
    return (step for name, step in STEPS.items() if name in task.steps)


def stamp(due: Due, began: float) -> dict[str, Any]:
    """What each part of a record has; ``began`` on the monotonic clock."""
    return {
        "key": due.key,
        "at": datetime.now(UTC).isoformat(timespec="seconds"),
        "seconds": round(time.monotonic() - began, 3),
        "provenance": provenance(due.code, due.blender),
    }
