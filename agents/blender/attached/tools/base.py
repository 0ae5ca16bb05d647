"""What tools of the open Blender share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agents.blender.tools.base import CallContext, ToolContext

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.blender.attached.attached_blender import AttachedBlender
    from agents.blender.attached.twin import Twin
    from agents.blender.tools.base import BlenderTool, Call, Check, Docs, Result


@dataclass(frozen=True, slots=True)
class AttachedContext:
    """The open Blender, its copy in the sandbox, and the knowledge base of its version."""

    open: AttachedBlender
    twin: Twin
    docs: Docs
    check: Check | None = None

    @property
    def of_open(self) -> CallContext:
        """The context of tools that call the open Blender itself."""
        return CallContext(self.open, self.docs, self.check)

    def of_twin(self, call: Call) -> ToolContext:
        """The context of tools that work in a copy of the scene, which is made now. Raises BlenderError."""
        return ToolContext(self.twin.refreshed(self.open, call.cancelled), self.docs, self.check)


@dataclass(frozen=True, slots=True)
class AttachedTool:
    """A tool of the suite, and how it runs with an open Blender."""

    tool: BlenderTool
    run: Callable[[AttachedContext, Any, Call], Result]
