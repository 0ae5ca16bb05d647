"""How progress looks on a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
)
from rich.text import Text

if TYPE_CHECKING:
    from rich.progress import Task
    from rich.progress_bar import ProgressBar


class _BarOfKnownLength(BarColumn):
    """Nothing where it is not known how much there is to do: a bar that does not move tells lies."""

    def render(self, task: Task) -> ProgressBar | Text:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The bar, or nothing."""
        return Text() if task.total is None else super().render(task)


def make_bars() -> Progress:
    """One line on stderr that is drawn when told to, and wiped off at the end."""
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        _BarOfKnownLength(bar_width=30),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        # A thread that draws would keep the readers of pages from using a second process.
        auto_refresh=False,
        transient=True,
    )
