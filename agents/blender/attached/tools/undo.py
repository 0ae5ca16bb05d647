"""``blender_undo``: takes back the newest steps of SimWorlds in the open Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from agents.blender.tools.base import Arguments, Call, Result
from simworlds.counting import format_list
from simworlds.sandbox.replies import Claim, Count, Name

if TYPE_CHECKING:
    from agents.blender.attached.tools.base import AttachedContext

NAME = "blender_undo"
_SECONDS = 120.0
_MOST = 256
_LISTED = 10


class UndoArguments(Arguments):
    """The arguments of ``blender_undo``."""

    steps: int = Field(default=1, ge=1, le=_MOST, description="How many.")


DESCRIPTION = """\
Take back your newest changes in the user's open Blender; each changing call is one step. Refused if the user has \
worked since: their work is never undone."""


class _Undone(Claim):
    undone: list[Name] = Field(max_length=_MOST)
    matches: bool | None
    left: Count


def run(context: AttachedContext, arguments: UndoArguments, call: Call) -> Result:
    """Undoes. Raises BlenderError."""
    undone = context.open.call(
        "undo",
        {"count": arguments.steps},
        _Undone.model_validate,
        timeout=_SECONDS,
        what="undoing",
        cancelled=call.cancelled,
    ).value
    text = f"Undone: {format_list(undone.undone, _LISTED)}. {undone.left} more of yours can be undone."
    if undone.matches:
        text += " The scene is as it was before them."
    elif undone.matches is None:
        text += " The scene is too large to compare it with what it was before."
    else:
        text += " **The scene is not quite what it was before them**: read its state."
    return Result(text, undone.model_dump(), failed=undone.matches is False)
