"""``blender_show``: shows the user something in their own window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from agents.blender.attached.tools.view import read_state
from agents.blender.tools.base import Arguments, Call, Result
from simworlds.counting import counted
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import Claim, Count, Frame

if TYPE_CHECKING:
    from agents.blender.attached.tools.base import AttachedContext

NAME = "blender_show"
_SECONDS = 60.0


class ShowArguments(Arguments):
    """The arguments of ``blender_show``."""

    objects: list[Annotated[str, Field(min_length=1, max_length=255)]] = Field(
        default_factory=list[str], max_length=200, description="Their names."
    )
    frame: Frame | None = Field(default=None, description="Go to this frame.")
    view: bool = Field(default=True, description="Fit the 3D view to the objects.")
    select: bool = Field(default=True, description="Select the objects, and nothing else.")
    mark: bool | None = Field(
        default=None,
        description="true: draw a ring with its name around each, over the view; false: remove all rings.",
    )


DESCRIPTION = """\
Show the user something in their own window: fit the 3D view to objects, select them, go to a frame, ring objects. \
Nothing that they made changes. This moves what they see: use it when they are to look at something, or asked."""


class _Rings(Claim):
    rings: Count
    removed: Count


def run(context: AttachedContext, arguments: ShowArguments, call: Call) -> Result:
    """Shows. Raises BlenderError."""
    if not arguments.objects and arguments.frame is None and arguments.mark is None:
        raise Refusal("There is nothing to show: give objects, a frame, or mark.")
    if arguments.mark and not arguments.objects:
        raise Refusal("Give the objects to mark.")
    lines: list[str] = []
    data: dict[str, Any] = {}
    if arguments.objects or arguments.frame is not None:
        request = arguments.model_dump(include={"objects", "frame", "view", "select"})
        names = ", ".join(arguments.objects[:3]) or f"frame {arguments.frame}"
        lines.append(
            context.open.call(
                "show",
                {**request, "step": f"show {names}"},
                read_state,
                timeout=_SECONDS,
                cancelled=call.cancelled,
            ).value
        )
    if arguments.mark is not None:
        rings = context.open.call(
            "mark",
            {"objects": arguments.objects if arguments.mark else []},
            _Rings.model_validate,
            timeout=_SECONDS,
            cancelled=call.cancelled,
        ).value
        data = rings.model_dump()
        lines.append(
            f"Drew {counted(rings.rings, 'ring')}." if rings.rings else f"Removed {rings.removed} rings."
        )
    return Result("\n".join(lines), data)
