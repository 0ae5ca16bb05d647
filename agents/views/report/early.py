"""Writes a run's report while it lasts: as stages close, and before a film, so that a run that is killed has one."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.loop.errors import NoRun
from agents.loop.record.events import Drafted, Event, StageMoved
from agents.views.report.page import write_report

if TYPE_CHECKING:
    from pathlib import Path

    from agents.loop.session import Watcher


@dataclass(frozen=True, slots=True)
class ReportWriter:
    """Passes on what it is told to another watcher; a report that cannot be written now is written at the end."""

    watcher: Watcher
    root: Path

    def take(self, event: Event) -> None:
        """See Watcher."""
        self.watcher.take(event)
        if isinstance(event, Drafted) or (isinstance(event, StageMoved) and event.type == "stage.closed"):
            with suppress(NoRun, OSError):
                write_report(self.root)

    def saying(self, role: str, text: str) -> None:
        """See Watcher."""
        self.watcher.saying(role, text)

    def asking_again(self, role: str, why: str) -> None:
        """See Watcher."""
        self.watcher.asking_again(role, why)

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See Watcher."""
        self.watcher.progress(tool, done, total, text)
