"""How a run may end early.

RunError
├── NoRun         there is no run in that folder, or none that can be gone on with
├── Unusable      what was given to work on cannot be worked on; to go on would come to the same
├── Stopping      the run is to stop here: a limit is reached, or somebody has asked for it; it can be taken up again
└── Aborted       a stage, or the model, cannot be got past (paper, Algorithm 1: retries and replans exhausted)
"""

from __future__ import annotations


class RunError(Exception):
    """Anything below. The message says what was wrong, and what can be done."""


class NoRun(RunError):  # noqa: N818 - these read as the states they name
    """There is no run in that folder, or none that can be gone on with."""


class Unusable(RunError):  # noqa: N818
    """What was given to work on cannot be worked on."""


class Stopping(RunError):  # noqa: N818
    """The run stops at a safe point; nothing is lost."""


class Aborted(RunError):  # noqa: N818
    """The run ends without its result; the last closed stage's checkpoint stands."""
