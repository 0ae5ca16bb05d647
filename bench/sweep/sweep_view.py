"""Shows the progress of a sweep: a live view on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from typing import IO, TYPE_CHECKING, Self

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from types import TracebackType

    from bench.sweep.executor import FinishedTask
    from bench.sweep.records import SceneRecord
    from bench.sweep.scene_task import SceneTask

_PER_SECOND = 4


class SweepView:
    """A context manager that prints a line for each scene that has ended; for logs."""

    def __init__(self, stream: IO[str], total: int) -> None:
        self._stream, self._total, self._count = stream, total, 0

    def doing(self, task: SceneTask | None, what: str) -> None:
        """Shows the progress of a task, on a terminal only; with None, of the sweep."""
        if task is None:
            self._write(what)

    def done(self, done: FinishedTask) -> None:
        """Shows a task that has ended."""
        self._count += 1
        self._write(f"[{self._count}/{self._total}] {describe_scene(done)}")

    def judged(self, task: SceneTask, record: SceneRecord) -> None:
        """Shows a scene whose frames were judged, or not."""
        self._write(describe_judgement(task, record))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None

    def _write(self, line: str) -> None:
        try:
            print(line, file=self._stream, flush=True)
        except (OSError, UnicodeError):
            return  # the reader is gone, or its encoding lacks a character: the sweep goes on


class LiveSweepView(SweepView):
    """Shows the running tasks above a progress bar; finished ones scroll by."""

    def __init__(self, console: Console, total: int) -> None:
        super().__init__(console.file, total)
        self._console = console
        self._bar = Progress(
            TextColumn("scenes"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console
        )
        self._all = self._bar.add_task("scenes", total=total)
        self._doing: dict[str, tuple[str, float]] = {}
        self._live = Live(
            get_renderable=self._drawn, console=console, refresh_per_second=_PER_SECOND, transient=True
        )

    def doing(self, task: SceneTask | None, what: str) -> None:
        """See SweepView."""
        super().doing(task, what)
        if task is not None:
            self._doing[task.spec.id] = (what, time.monotonic())

    def done(self, done: FinishedTask) -> None:
        """See SweepView."""
        self._doing.pop(done.task.spec.id, None)
        self._bar.advance(self._all)
        self._write(describe_scene(done))

    def __enter__(self) -> Self:
        self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.__exit__(kind, error, trace)

    def _write(self, line: str) -> None:
        self._console.print(Text(line))

    def _drawn(self) -> Group:
        rows = Table.grid(padding=(0, 2))
        for scene, (what, since) in sorted(self._doing.items()):
            rows.add_row(
                Text(f"  {scene}"), Text(what), Text(f"{time.monotonic() - since:.0f} s", style="dim")
            )
        return Group(rows, self._bar)


def make_view(stream: IO[str], total: int) -> SweepView:
    """The view that fits ``stream``; ``total``: the number of tasks."""
    console = Console(file=stream)
    if stream.isatty() and not console.is_dumb_terminal:
        return LiveSweepView(console, total)
    return SweepView(stream, total)


def describe_scene(done: FinishedTask) -> str:
    """Describes a scene that has ended, in one line."""
    scene, record = done.task.spec.id, done.record
    if record is None:
        return f"{scene:<16} could not be done: {printable(done.fault)}"
    audited = record.audited
    if audited is None:
        return f"{scene:<16} {record.produced.outcome if record.produced else 'nothing'}"
    if audited.why is not None:
        return f"{scene:<16} not scored: {printable(audited.why)}"
    frames = len(record.framed.frames) if record.framed is not None else 0
    none = (
        f", no frames: {printable(record.framed.why)}"
        if record.framed is not None and record.framed.why
        else ""
    )
    return (
        f"{scene:<16} MPR {format_score(audited.mpr)}  SPR {format_score(audited.spr)}  {frames} frames{none}"
    )


def describe_judgement(task: SceneTask, record: SceneRecord) -> str:
    """Describes a judgement in one line."""
    judged = record.judged
    if judged is None or judged.why is not None:
        return f"{task.spec.id:<16} not judged: {printable(judged.why if judged and judged.why else 'no judgement')}"
    return f"{task.spec.id:<16} VLM {format_score(judged.score)}"


def format_score(value: float | None) -> str:
    """Formats a score."""
    return "–" if value is None else f"{value:.3f}"


def printable(text: str) -> str:
    """Untrusted text in one line, without control characters."""
    return "".join(char if char.isprintable() else " " for char in text)[:300]
