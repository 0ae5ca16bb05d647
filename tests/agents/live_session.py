"""A real Blender behind the real supervisor, and short ways to use it."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any

from agents.blender.files.run_folder import RunFolder
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from agents.blender.tools.base import BlenderTool, Call, Result, ToolContext, parse, perform
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from pathlib import Path

    from simworlds.sandbox.confinement.confined_command import Sandbox


def no_docs(query: str, *, max_tokens: int = 400) -> str:
    """Stands for a knowledge base that was not built."""
    del query, max_tokens
    return ""


class LiveSession:
    """A session, and short ways to use it."""

    def __init__(
        self,
        root: Path,
        *,
        sandbox: Sandbox | None = None,
        blender_exe: Path | None = None,
        read: tuple[Path, ...] = (),
    ) -> None:
        folder = RunFolder.make(root)
        launch = make_launch(folder.workspace, sandbox=sandbox, blender_exe=blender_exe, read=read)
        self.blender = Supervisor(launch, folder)
        self.blender.start()
        self.context = ToolContext(self.blender, no_docs)

    def use(self, tool: BlenderTool, call: Call | None = None, **arguments: Any) -> Result:
        """Calls a tool as the server does."""
        return perform(tool, self.context, parse(tool, arguments), call or Call())

    def run(self, code: str, timeout: float = 120.0) -> Any:
        """Runs code that must not fail; returns the value of its final expression as Python sees it."""
        reply = self.blender.call("execute", {"code": code}, unread, timeout=timeout, changes=True)
        assert reply.value["error"] is None, reply.value["error"]["traceback"]
        value = reply.value["value"]
        try:
            return ast.literal_eval(value) if value is not None else None
        except (ValueError, SyntaxError):
            return value

    def empty(self) -> None:
        """Begins again with an empty scene. Preferences stay: setting them back takes five times as long."""
        self.run("bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)")
