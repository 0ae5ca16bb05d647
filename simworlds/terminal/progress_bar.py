"""A progress bar on a terminal."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
)
from rich.text import Text

from simworlds.terminal.console import Console

if TYPE_CHECKING:
    from rich.progress import Task
    from rich.progress_bar import ProgressBar


class _KnownLengthColumn(BarColumn):
    """A bar, but only where it is known how much there is to do."""

    def render(self, task: Task) -> ProgressBar | Text:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The bar, or nothing."""
        return Text() if task.total is None else super().render(task)


def start_bar() -> Progress:
    """Starts a bar with one task on stderr; it is drawn on request only, and vanishes when it is stopped."""
    bar = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        _KnownLengthColumn(bar_width=30),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        console=Console(sys.stderr),
        # A drawing thread would make forking unsafe (simworlds.forked), and builds read pages in a second process.
        auto_refresh=False,
        transient=True,
    )
    bar.add_task("", total=None)
    bar.start()
    return bar
