"""Errors between SimWorlds and a Blender.

BlenderError
├── RuntimeMissing     no interpreter with the wanted Blender version, and none could be installed
│   └── NotInstalled   it may be installed, but not without leave
├── ProgramFailed      a program that ran in Blender did not finish
├── CannotStart        there is no Blender, or it does not start
├── Refusal            the tool cannot do this; Blender still runs
│   ├── MissingModule  this Blender's Python lacks a module that the tool needs
│   └── NotThere       there is no such file
├── ToolBroke          the tool itself failed; Blender still runs
└── Lost               this Blender is gone, and its state with it
    ├── Died           it crashed, or code ended it
    │   └── NeverBegan it had ended before the call reached it
    ├── TookTooLong    it ran past its deadline, and was killed
    ├── Interrupted    the caller cancelled the call, and it was killed
    ├── LimitExceeded  it used more than its limits allow, and was killed
    ├── LeftBehind     code returned, but left what would break later calls, and it was killed
    └── Untrustworthy  a message did not come from the worker, and it was killed
"""

from __future__ import annotations

from simworlds.errors import UserError


class BlenderError(UserError):
    """Base of all of them."""


class RuntimeMissing(BlenderError):  # noqa: N818
    """No interpreter with the wanted Blender version was found or could be installed."""


class NotInstalled(RuntimeMissing):
    """There was no leave to install Blender ``version``."""

    def __init__(self, version: str) -> None:
        self.version = version
        super().__init__(f"Blender {version} is not installed.")


class ProgramFailed(BlenderError):  # noqa: N818
    """A program that ran in Blender did not finish; carries the end of its output."""


class CannotStart(BlenderError):  # noqa: N818 - these read as the states they name
    """There is no Blender, or it does not start."""


class Refusal(BlenderError):  # noqa: N818
    """The tool cannot do this; the message says why."""


class MissingModule(Refusal):
    """This Blender's Python lacks ``module``, which the tool needs."""

    def __init__(self, module: str) -> None:
        self.module = module
        super().__init__(
            f"This tool needs the Python module {module}, which this Blender lacks. Blenders from blender.org have it; "
            f"for the system's Blender, install the system's {module} (Debian: apt-get install python3-{module})."
        )


class NotThere(Refusal):
    """There is no such file."""


class ToolBroke(BlenderError):  # noqa: N818
    """The tool itself failed; ``details`` is its traceback."""

    def __init__(self, message: str, details: str = "") -> None:
        self.details = details
        super().__init__(message)


class Lost(BlenderError):  # noqa: N818
    """This Blender is gone. ``printed`` is the end of its output, ``ending`` how its process ended, if by itself."""

    def __init__(self, message: str, printed: str = "", ending: str = "") -> None:
        self.printed = printed
        self.ending = ending
        super().__init__(message)


class Died(Lost):
    """Blender crashed, or code ended it."""


class NeverBegan(Died):
    """Blender had ended before the call reached it; nothing of the call was done."""


class TookTooLong(Lost):
    """The call ran past its deadline."""


class Interrupted(Lost):
    """The caller cancelled the call."""


class LimitExceeded(Lost):
    """Blender used more disk, memory or threads than its limits allow."""


class LeftBehind(Lost):
    """Code returned, but left something that would break later calls: threads, hooks."""


class Untrustworthy(Lost):
    """Bytes on the channel were not written by the worker."""
