"""What a person sees of a run while it lasts: a view that is redrawn on a terminal, lines elsewhere.

What a model, a tool or a scene says is not trusted: none of its control characters are printed.
"""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Self

from agents.loop.record.events import ModelAsked, ToolAnswered, ToolCalled
from agents.loop.record.reducer import after
from agents.loop.record.run_state import RunState
from agents.roles.names import format_role
from agents.views.event_lines import format_event
from agents.views.formatting import format_clock
from agents.views.now import Now, ToolProgress
from agents.views.rich_views import run_in_progress
from simworlds.terminal.console import Console
from simworlds.terminal.lines import is_terminal, write_line
from simworlds.terminal.live_view import LiveView
from simworlds.terminal.text import shortened

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import TextIO

    from rich.console import RenderableType

    from agents.loop.record.events import Event

_PER_SECOND = 8
_LINE_SECONDS = 10.0  # between two lines on the progress of a tool
_WORDS = 2000  # letters of what is being said that are kept
_LETTERS = 200  # of a line


class RunView:
    """Shows nothing, and keeps the run's state. Everything may be called from any thread, see ``Watcher``."""

    def __init__(self, before: RunState | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self.run_state = before or RunState()
        self._lock = threading.RLock()
        self._clock = clock
        self._taken = clock()

    def take(self, event: Event) -> None:
        """See Watcher."""
        with self._lock:
            self.run_state = after(self.run_state, event)
            self._taken = self._clock()

    @property
    def _since(self) -> float:
        """Seconds since the last event."""
        return self._clock() - self._taken

    def saying(self, role: str, text: str) -> None:
        """See Watcher."""

    def asking_again(self, role: str, why: str) -> None:
        """See Watcher."""

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See Watcher."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None


class RunLog(RunView):
    """A line for each event, with the time that was worked."""

    def __init__(
        self, stream: TextIO, before: RunState | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(before, clock)
        self._stream = stream
        self._written: dict[str, float] = {}

    def take(self, event: Event) -> None:
        """See Watcher."""
        with self._lock:
            super().take(event)
            for line in format_event(event, self.run_state):
                self._write(line)

    def asking_again(self, role: str, why: str) -> None:
        """See Watcher."""
        with self._lock:
            self._write(f"  {format_role(role)} has no answer: {why}", self._since)

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See Watcher. Not more often than every ten seconds."""
        with self._lock:
            now = self._clock()
            if now - self._written.setdefault(tool, now) < _LINE_SECONDS:
                return
            self._written[tool] = now
            share = f" {min(100.0, 100 * done / total):.0f} %" if total else ""
            self._write(f"  {tool}{share} {text}", now - self._taken)

    def _write(self, line: str, since: float = 0.0) -> None:
        bare = line.lstrip(" ")
        indent = " " * min(8, len(line) - len(bare))
        clock = format_clock(self.run_state.seconds + since)
        write_line(self._stream, f"{clock}  {indent}{shortened(bare, _LETTERS)}")


class RunScreen(LiveView, RunView):
    """The run on a terminal; its last state stays."""

    def __init__(self, console: Console, folder: str = "", before: RunState | None = None) -> None:
        RunView.__init__(self, before)
        self._folder = folder
        self._words: dict[str, str] = {}
        self._progress: dict[str, ToolProgress] = {}
        self._is_open = False
        LiveView.__init__(self, console, _PER_SECOND)  # draws for the first time

    def take(self, event: Event) -> None:
        """See Watcher."""
        with self._lock:
            super().take(event)
            if isinstance(event, ModelAsked):
                self._words.pop(event.role, None)
            if isinstance(event, ToolCalled | ToolAnswered):
                self._progress.pop(event.name, None)

    def saying(self, role: str, text: str) -> None:
        """See Watcher."""
        with self._lock:
            self._words[role] = (self._words.get(role, "") + text)[-_WORDS:]

    def asking_again(self, role: str, why: str) -> None:
        """See Watcher. Of a broken answer nothing is kept."""
        with self._lock:
            self._words[role] = f"{why}\n"

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """See Watcher."""
        with self._lock:
            self._progress[tool] = ToolProgress(done, total, text)

    def draw(self) -> RenderableType:
        """See LiveView."""
        with self._lock:
            since = self._since if self._is_open and not self.run_state.ending else 0.0
            now = Now(self.run_state.seconds + since, dict(self._words), dict(self._progress), self._folder)
            return run_in_progress(self.run_state, now, self._console.height)

    def __enter__(self) -> Self:
        self._is_open = True
        return super().__enter__()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._is_open = False
        super().__exit__(kind, error, trace)


def make_view(stream: TextIO, folder: str = "", before: RunState | None = None) -> RunView:
    """The view that fits where ``stream`` goes. ``folder`` is the run's, ``before`` its state so far."""
    if is_terminal(stream):
        return RunScreen(Console(stream), folder, before)
    return RunLog(stream, before)
