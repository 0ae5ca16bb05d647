"""The interface of what runs a sweep's tasks, and the one that runs them on this machine."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from bench.sweep.run_steps import do_scene
from bench.worker_processes import run_in_processes

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from bench.sweep.records import SceneRecord
    from bench.sweep.scene_task import SceneTask


@dataclass(frozen=True, slots=True)
class FinishedTask:
    """A task that has ended: its record, or ``fault`` in words."""

    task: SceneTask
    record: SceneRecord | None
    fault: str = ""


class Executor(Protocol):
    """Runs tasks."""

    def work(
        self, tasks: Sequence[SceneTask], tell: Callable[[SceneTask | None, str], None]
    ) -> Generator[FinishedTask]:
        """Runs all tasks; yields each when it has ended.

        ``tell`` is called with the progress of a task; with None, of the sweep. All tasks end when the caller closes
        the generator or KeyboardInterrupt passes through it.
        """
        ...


@dataclass(frozen=True, slots=True)
class LocalExecutor:
    """Runs ``jobs`` tasks at a time."""

    jobs: int = 1

    def work(
        self, tasks: Sequence[SceneTask], tell: Callable[[SceneTask | None, str], None]
    ) -> Generator[FinishedTask]:
        """See Executor."""
        with closing(run_in_processes(tasks, do_scene, self.jobs, tell)) as results:
            for task, record, fault in results:
                yield FinishedTask(task, record, fault)
