"""What a person sees of a run while it lasts: a view that is drawn anew on a terminal, plain lines elsewhere.

Everything that a model, a tool or a scene says is taken for hostile: no control character of theirs gets out.
"""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol, Self

from rich.console import Console
from rich.live import Live

from agents.loop.events import ModelAsked, ToolAnswered, ToolCalled
from agents.loop.reducer import after
from agents.loop.run_state import RunState
from agents.views.event_lines import format_event
from agents.views.formatting import shortened, told_clock
from agents.views.rich_views import Now, Progress, working

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import TextIO

    from agents.loop.events import Event

_PER_SECOND = 8
_LINE_SECONDS = 10.0  # between two lines on the progress of a tool
_WORDS = 2000  # letters of what is being said that are kept
_LETTERS = 200  # of a line


class View(Protocol):
    """Somebody who looks on. Everything may be called from any thread, between entering and leaving."""

    def take(self, event: Event) -> None:
        """An event was written to the journal."""
        ...

    def saying(self, role: str, text: str) -> None:
        """A model goes on speaking: the next words, as they come."""
        ...

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """A tool has got so far."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def make_view(stream: TextIO, folder: str = "", before: RunState | None = None) -> View:
    """The view that fits where ``stream`` goes. ``folder`` is the run's, ``before`` what has been of it already."""
    console = Console(file=stream)
    if stream.isatty() and not console.is_dumb_terminal:
        return Screen(stream, folder, before, console)
    return Lines(stream, before)


class Quiet:
    """Shows nothing, and keeps the picture."""

    def __init__(self, before: RunState | None = None) -> None:
        self.run_state = before or RunState()
        self._lock = threading.RLock()

    def take(self, event: Event) -> None:
        """See View."""
        with self._lock:
            self.run_state = after(self.run_state, event)

    def saying(self, role: str, text: str) -> None:
        """See View."""

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See View."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None


class Lines(Quiet):
    """A line for each event, with the time that was worked; for logs."""

    def __init__(
        self, stream: TextIO, before: RunState | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(before)
        self._stream = stream
        self._clock = clock
        self._told: dict[str, float] = {}

    def take(self, event: Event) -> None:
        """See View."""
        with self._lock:
            super().take(event)
            for line in format_event(event, self.run_state):
                self._write(line)

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See View. Not more often than every ten seconds."""
        with self._lock:
            now = self._clock()
            if now - self._told.setdefault(tool, now) < _LINE_SECONDS:
                return
            self._told[tool] = now
            share = f" {min(100.0, 100 * done / total):.0f} %" if total else ""
            self._write(f"  {tool}{share} {text}")

    def _write(self, line: str) -> None:
        """Whoever reads may be gone, or know no such letters: the run goes on."""
        text = f"{told_clock(self.run_state.seconds)}  {_indented(line)}\n"
        encoding = getattr(self._stream, "encoding", None) or "utf-8"
        with suppress(OSError, ValueError):
            self._stream.write(text.encode(encoding, "replace").decode(encoding))
            self._stream.flush()


def _indented(line: str) -> str:
    """One line, its own spaces at the beginning kept."""
    bare = line.lstrip(" ")
    return " " * min(8, len(line) - len(bare)) + shortened(bare, _LETTERS)


class Screen(Quiet):
    """The run on a terminal: drawn anew several times a second; its last state stays."""

    def __init__(
        self,
        stream: TextIO,
        folder: str = "",
        before: RunState | None = None,
        console: Console | None = None,
    ) -> None:
        super().__init__(before)
        self._console = console or Console(file=stream)
        self._folder = folder
        self._words: dict[str, str] = {}
        self._progress: dict[str, Progress] = {}
        self._taken = time.monotonic()
        self._is_open = False
        self._live = Live(
            get_renderable=self._drawn,
            console=self._console,
            refresh_per_second=_PER_SECOND,
            redirect_stdout=False,
            redirect_stderr=False,
        )

    def take(self, event: Event) -> None:
        """See View."""
        with self._lock:
            super().take(event)
            self._taken = time.monotonic()
            if isinstance(event, ModelAsked):
                self._words.pop(event.role, None)
            if isinstance(event, ToolCalled | ToolAnswered):
                self._progress.pop(event.name, None)

    def saying(self, role: str, text: str) -> None:
        """See View."""
        with self._lock:
            self._words[role] = (self._words.get(role, "") + text)[-_WORDS:]

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See View."""
        with self._lock:
            self._progress[tool] = Progress(done, total, text)

    def _drawn(self) -> Any:
        with self._lock:
            since = time.monotonic() - self._taken if self._is_open and not self.run_state.ending else 0.0
            now = Now(self.run_state.seconds + since, dict(self._words), dict(self._progress), self._folder)
            return working(self.run_state, now, self._console.height)

    def __enter__(self) -> Self:
        self._is_open = True
        with suppress(OSError):
            self._live.start(refresh=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._is_open = False
        with suppress(OSError):  # the terminal may be gone
            self._live.stop()
