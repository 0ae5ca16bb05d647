"""What can go wrong between SimWorlds and a Blender.

BlenderError
├── RuntimeMissing     no interpreter with the Blender version asked for, and none could be made
├── ProgramFailed      a program that ran in Blender did not finish
├── CannotStart        no Blender to be had, or it does not come up
├── Refusal            the tool cannot do as asked; Blender is well
│   └── MissingModule  this Blender's Python lacks a module that the tool needs
├── ToolBroke          the tool itself failed; Blender is well
└── Lost               this Blender is gone and its state with it
    ├── Died           it crashed, or code ended it
    │   └── NeverBegan it had ended before the call reached it
    ├── TookTooLong    it was past its deadline, and was killed
    ├── Interrupted    the caller gave the call up, and it was killed
    ├── OutOfBounds    it wrote or started more than it may, and was killed
    ├── LeftBehind     code returned, but left what would spoil later calls, and it was killed
    └── Untrustworthy  what came from it was not written by our side, and it was killed
"""

from __future__ import annotations

from simworlds.errors import UserError


class BlenderError(UserError):
    """Anything below."""


class RuntimeMissing(BlenderError):  # noqa: N818
    """No interpreter with the Blender version asked for was found or could be made."""


class ProgramFailed(BlenderError):  # noqa: N818
    """A program that ran in Blender did not finish; carries the end of its output."""


class CannotStart(BlenderError):  # noqa: N818 - these read as the states they name
    """There is no Blender to be had, or it does not come up."""


class Refusal(BlenderError):  # noqa: N818
    """The tool cannot do as asked; the message says why."""


class MissingModule(Refusal):
    """This Blender's Python lacks ``module``, which the tool needs."""

    def __init__(self, module: str) -> None:
        self.module = module
        super().__init__(
            f"This Blender's Python has no {module}, which this tool needs. Blenders from blender.org bring it; for a "
            f"system's own one, install the system's {module} (Debian: apt-get install python3-{module})."
        )


class ToolBroke(BlenderError):  # noqa: N818
    """The tool itself failed; ``details`` is its traceback."""

    def __init__(self, message: str, details: str = "") -> None:
        self.details = details
        super().__init__(message)


class Lost(BlenderError):  # noqa: N818
    """This Blender is gone. ``printed`` is the end of what it said, ``ending`` how its process ended, if by itself."""

    def __init__(self, message: str, printed: str = "", ending: str = "") -> None:
        self.printed = printed
        self.ending = ending
        super().__init__(message)


class Died(Lost):
    """Blender crashed, or code ended it."""


class NeverBegan(Died):
    """Blender had ended before the call reached it: nothing of the call was done."""


class TookTooLong(Lost):
    """The call was past its deadline."""


class Interrupted(Lost):
    """The caller gave the call up."""


class LimitExceeded(Lost):
    """More was written to disk, or started, than may be."""


class LeftBehind(Lost):
    """Code returned, but left something that would spoil the calls after it: threads, hooks."""


class Untrustworthy(Lost):
    """Bytes came over the channel that our side of it had not written."""
