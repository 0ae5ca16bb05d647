"""A progress bar on a terminal."""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    TaskProgressColumn,
    TimeElapsedColumn,
)
from rich.text import Text

from simworlds.operating_system import SYSTEM
from simworlds.terminal.console import Console

if TYPE_CHECKING:
    from rich.progress import Task
    from rich.progress_bar import ProgressBar

_DRAW_SECONDS = 0.25


class _LabelColumn(ProgressColumn):
    """What is being done: on a narrow terminal it is cut, where the clock is not."""

    def render(self, task: Task) -> Text:
        """The description."""
        return Text(task.description, no_wrap=True, overflow="ellipsis")


class _KnownLengthColumn(BarColumn):
    """A bar, but only where it is known how much there is to do."""

    def render(self, task: Task) -> ProgressBar | Text:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The bar, or nothing."""
        return Text() if task.total is None else super().render(task)


class RunningBar:
    """A bar with one task on stderr, whose clock and spinner go on while the task works; it vanishes when stopped."""

    def __init__(self) -> None:
        self._is_drawing = False
        self._bar = Progress(
            SpinnerColumn(),
            _LabelColumn(),
            _KnownLengthColumn(bar_width=30),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            console=Console(sys.stderr),
            # A drawing thread would make forking unsafe (simworlds.forked), and builds read pages in a second process.
            auto_refresh=False,
            transient=True,
        )
        self._task = self._bar.add_task("", total=None)
        self._bar.start()
        self._end_redrawing = SYSTEM.repeat(self._redraw, _DRAW_SECONDS)

    def show(self, label: str, done: int, total: int | None) -> None:
        """Draws what is being done, and how much of it is done."""
        self._is_drawing = True
        try:
            self._bar.update(self._task, description=label, completed=done, total=total, refresh=True)
        finally:
            self._is_drawing = False

    def stop(self) -> None:
        """Wipes the bar."""
        self._end_redrawing()
        self._bar.stop()

    def _redraw(self) -> None:
        """Called in the midst of any code, which must not be told that the terminal is gone, or busy with its line."""
        if not self._is_drawing:
            with suppress(OSError, RuntimeError):
                self._bar.refresh()
