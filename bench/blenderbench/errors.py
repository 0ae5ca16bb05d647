"""What can go wrong between a set of tasks and its scores.

BlenderBenchError
├── NoTasks      a folder that is no BlenderBench, or a task that it does not have
├── BadPicture   a picture that cannot be compared: no PNG, broken, or too large
├── NoWeights    CLIP's weights are not there, or are something else
├── BadResults   a folder of results that cannot be gone on with, or read
├── NotReady     a system that cannot be run here; no task could be
└── NotDone      a task that came to nothing; its record says why, and the others go on
"""

from __future__ import annotations


class BlenderBenchError(Exception):
    """Anything below. The message says what was wrong, where, and what can be done."""


class NoTasks(BlenderBenchError):  # noqa: N818 - these read as the states they name
    """There is no such set, or no such task in it."""


class BadPicture(BlenderBenchError):  # noqa: N818
    """A picture cannot be compared."""


class NoWeights(BlenderBenchError):  # noqa: N818
    """CLIP's weights cannot be had."""


class BadResults(BlenderBenchError):  # noqa: N818
    """Results cannot be gone on with, or read."""


class NotReady(BlenderBenchError):  # noqa: N818
    """A system cannot be run here."""


class NotDone(BlenderBenchError):  # noqa: N818
    """A task came to nothing."""
