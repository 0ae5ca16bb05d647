"""Errors of BlenderBench.

BlenderBenchError
├── NoTasks      the folder is not a BlenderBench, or has no such task
├── UnreadableRender   a picture that cannot be compared: not a PNG, broken, or too large
├── NoWeights    CLIP's weights are missing or invalid
├── BadResults   a folder of results that cannot be continued or read
├── EditSystemNotReady     a system that cannot run here; no task was started
└── TaskFailed      a task that failed; its record says why, and the others go on
"""

from __future__ import annotations


class BlenderBenchError(Exception):
    """Base class. The message says what is wrong, where, and what to do."""


class NoTasks(BlenderBenchError):  # noqa: N818 - these read as the states they name
    """The set or the task does not exist."""


class UnreadableRender(BlenderBenchError):  # noqa: N818
    """A picture cannot be compared."""


class NoWeights(BlenderBenchError):  # noqa: N818
    """CLIP's weights are missing or invalid."""


class BadResults(BlenderBenchError):  # noqa: N818
    """Results cannot be continued or read."""


class EditSystemNotReady(BlenderBenchError):  # noqa: N818
    """A system cannot run here."""


class TaskFailed(BlenderBenchError):  # noqa: N818
    """A task failed."""
