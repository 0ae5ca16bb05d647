"""A client's session with the open Blender: the connection, the copy in the sandbox, and the run's folder."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.blender.attached.attached_blender import AttachedBlender
from agents.blender.attached.tool_catalogue import RUN
from agents.blender.attached.tools.base import AttachedContext
from agents.blender.attached.twin import Twin
from agents.blender.blender_sessions import BlenderSession, SessionSetup
from agents.blender.tools.base import Call, Knowledge, Result, parse, with_note
from simworlds.sandbox.errors import BlenderError, Refusal

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.blender.attached.open_blenders import About
    from agents.blender.files.run_folder import RunFolder
    from agents.blender.jobs import SessionJobs
    from agents.blender.tools.base import BlenderTool

_CLIENT = "SimWorlds MCP"
COPIES = "before-changes"


class AttachedSession(BlenderSession):
    """As ``BlenderSession``, with the user's Blender: ``wanted`` says which (see ``open_blenders.choose``)."""

    def __init__(
        self,
        wanted: str,
        setup: SessionSetup,
        folder: RunFolder | None = None,
        jobs: SessionJobs | None = None,
    ) -> None:
        super().__init__(setup, folder, jobs)
        self._twin: Twin | None = None
        self._attached = AttachedBlender(wanted, _CLIENT, self._place_of_copy, setup.tell)

    def cancel(self) -> None:
        """See BlenderSession."""
        super().cancel()
        self._attached.end()
        if self._twin is not None:
            self._twin.end()

    # In the session's own thread

    def _started(self) -> None:
        try:
            self._attached.about  # noqa: B018 - connects
            self._copies().started(self._attached)
        except BlenderError as error:
            self._setup.tell(str(error))

    def _use(
        self,
        tool: BlenderTool,
        arguments: dict[str, Any] | None,
        call: Call,
        about: Callable[[str], Knowledge],
    ) -> Result:
        parsed = parse(tool, arguments)
        if self._ended:
            raise Refusal("This session has ended.")
        version = self._attached.about.version
        if call.cancelled.is_set():
            raise Refusal(f"{tool.name} was cancelled before it began.")
        self._unused = False
        call.begin()
        known = about(version)
        context = AttachedContext(self._attached, self._copies(), known.docs, known.check)
        return with_note(RUN[tool.name](context, parsed, call), self._attached)

    def _copies(self) -> Twin:
        if self._twin is None:
            self._twin = Twin(self._in_folder(), self._setup.sandbox, self._setup.tell)
        return self._twin

    def _place_of_copy(self, about: About) -> str:
        folder = self._in_folder().root / COPIES
        folder.mkdir(exist_ok=True)
        stem = Path(about.file).stem if about.file else "unsaved"
        return str(folder / f"{stem}-{datetime.now().astimezone():%H%M%S}.blend")

    def _close(self) -> None:
        self._attached.close()
        if self._twin is not None:
            self._twin.close()
        super()._close()
