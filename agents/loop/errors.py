"""How a run may end early.

RunError
├── NoRun         the folder does not hold a run that can be continued
├── Unusable      an input file cannot be used; resuming would fail again
├── NotSaved      the scene cannot be saved: a coder may mend that; resuming tries again
├── NotRendered   the scene cannot be rendered: as NotSaved
├── Stopping      the run stops here: a limit is reached, or the user asked for it; it can be resumed
└── Aborted       a stage could not be closed (paper, Algorithm 1: retries and replans exhausted)
"""

from __future__ import annotations

from simworlds.errors import UserError


class RunError(UserError):
    """Base of all of them."""


class NoRun(RunError):  # noqa: N818 - these read as the states they name
    """The folder does not hold a run that can be continued."""


class Unusable(RunError):  # noqa: N818
    """An input file cannot be used."""


class NotSaved(RunError):  # noqa: N818
    """The scene cannot be saved; it is still open, as it is."""


class NotRendered(RunError):  # noqa: N818
    """The scene cannot be rendered."""


class Stopping(RunError):  # noqa: N818
    """The run stops at a safe point; nothing is lost."""


class Aborted(RunError):  # noqa: N818
    """The run ends without its result; the last closed stage's checkpoint stands."""
