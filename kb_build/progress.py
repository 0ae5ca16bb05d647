"""How a build shows that it is alive: bars on a terminal, plain lines elsewhere, always on stderr."""

from __future__ import annotations

import sys
import time
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Generator

    from rich.progress import Progress as Bars
    from rich.progress import TaskID

_LINE_SECONDS = 2.0
_DRAW_SECONDS = 0.1


class Progress(Protocol):
    """Called with what is being done, how much of it is done, and of how much (None: not known)."""

    def __call__(self, label: str, done: int, total: int | None, /) -> None:  # noqa: D102 - as above
        ...


def silent(label: str, done: int, total: int | None, /) -> None:
    """Progress that nobody wants to see."""
    del label, done, total


class PlainProgress:
    """A line when something begins, and one every two seconds while it lasts."""

    def __init__(self) -> None:
        self._label = ""
        self._written = 0.0

    def __call__(self, label: str, done: int, total: int | None, /) -> None:
        """Writes a line on stderr, unless the last one is young and about the same thing."""
        now = time.monotonic()
        if label == self._label and now - self._written < _LINE_SECONDS:
            return
        self._label, self._written = label, now
        text = f"{label}: {done * 100 // total} %" if total and done else label
        print(f"{text} ...", file=sys.stderr, flush=True)  # noqa: T201 - this is where lines are for


class TerminalProgress:
    """One bar for what is being done now, with the time it takes; nothing of it stays on the screen."""

    def __init__(self) -> None:
        self._bars: Bars | None = None
        self._task: TaskID | None = None
        self._label = ""
        self._drawn = 0.0

    def __call__(self, label: str, done: int, total: int | None, /) -> None:
        """Draws the bar, at most ten times a second."""
        bars = self._bars or self._start()
        now = time.monotonic()
        if label != self._label or self._task is None:
            if self._task is not None:
                bars.remove_task(self._task)
            self._task, self._label, self._drawn = bars.add_task(label, total=total), label, 0.0
        if now - self._drawn >= _DRAW_SECONDS or done == total:
            bars.update(self._task, completed=done, total=total, refresh=True)
            self._drawn = now

    def _start(self) -> Bars:
        from rich.console import Console  # noqa: PLC0415 - a build that does nothing draws nothing
        from rich.progress import (  # noqa: PLC0415
            BarColumn,
            Progress,
            SpinnerColumn,
            TaskProgressColumn,
            TextColumn,
            TimeElapsedColumn,
        )

        self._bars = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(bar_width=30),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            console=Console(stderr=True),
            # Its own thread would keep the readers of pages from using a second process.
            auto_refresh=False,
            transient=True,
        )
        self._bars.start()
        return self._bars

    def close(self) -> None:
        """Takes the bar off the screen."""
        if self._bars is not None:
            self._bars.stop()
            self._bars = None


@contextmanager
def shown_progress() -> Generator[Progress]:
    """The progress that fits where stderr goes."""
    if not sys.stderr.isatty():
        yield PlainProgress()
        return
    with closing(TerminalProgress()) as progress:
        yield progress
