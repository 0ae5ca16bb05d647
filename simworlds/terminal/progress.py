"""How a build shows its progress: a bar on a terminal, lines elsewhere, always on stderr."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from simworlds.terminal.lines import is_terminal, write_line

if TYPE_CHECKING:
    from collections.abc import Generator

    from simworlds.terminal.progress_bar import RunningBar

_LINE_SECONDS = 2.0
_DRAW_SECONDS = 0.1


class Progress(Protocol):
    """Called with what is being done, how much of it is done, and of how much (None: not known)."""

    def __call__(self, label: str, done: int, total: int | None, /) -> None:  # noqa: D102 - as above
        ...


def silent(label: str, done: int, total: int | None, /) -> None:
    """Shows nothing."""
    del label, done, total


class _Throttle:
    """Lets through what is new, and what is old once in so many seconds."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._last = ("", 0.0)

    def lets(self, label: str) -> bool:
        label_before, then = self._last
        now = time.monotonic()
        if label == label_before and now - then < self._seconds:
            return False
        self._last = (label, now)
        return True


class _ProgressLines:
    """A line when something begins, and one every two seconds while it lasts."""

    def __init__(self) -> None:
        self._throttle = _Throttle(_LINE_SECONDS)

    def __call__(self, label: str, done: int, total: int | None, /) -> None:
        if self._throttle.lets(label):
            text = f"{label}: {done * 100 // total} %" if total and done else label
            write_line(sys.stderr, f"{text} ...")


class _ProgressBar:
    """A bar for what is being done now, drawn at most ten times a second for what is old; it vanishes at the end."""

    def __init__(self) -> None:
        self._bar: RunningBar | None = None
        self._throttle = _Throttle(_DRAW_SECONDS)

    def __call__(self, label: str, done: int, total: int | None, /) -> None:
        if self._bar is None:
            from simworlds.terminal.progress_bar import RunningBar  # noqa: PLC0415 - slow to load, often not needed

            self._bar = RunningBar()
        if self._throttle.lets(label) or done == total:
            self._bar.show(label, done, total)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.stop()


@contextmanager
def shown_progress(*, in_logs: bool = True) -> Generator[Progress]:
    """The progress that fits where stderr goes. Without ``in_logs``, for what takes seconds, only on a terminal."""
    if not is_terminal(sys.stderr):
        yield _ProgressLines() if in_logs else silent
        return
    bar = _ProgressBar()
    try:
        yield bar
    finally:
        bar.close()
