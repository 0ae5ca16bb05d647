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
    """A line with what is being done now and the time since the start; nothing of it stays on the screen."""

    def __init__(self) -> None:
        self._bars: Bars | None = None
        self._task: TaskID | None = None
        self._label = ""
        self._drawn = 0.0

    def __call__(self, label: str, done: int, total: int | None, /) -> None:
        """Draws the bar, at most ten times a second."""
        bars = self._bars or self._start()
        now = time.monotonic()
        if self._task is None:
            self._task = bars.add_task(label, total=total)
        if label != self._label or done == total or now - self._drawn >= _DRAW_SECONDS:
            bars.update(self._task, description=label, completed=done, total=total)
            bars.refresh()
            self._label, self._drawn = label, now

    def _start(self) -> Bars:
        from simworlds.terminal.progress_columns import make_bars  # noqa: PLC0415 - a build that does nothing draws nothing

        self._bars = make_bars()
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
