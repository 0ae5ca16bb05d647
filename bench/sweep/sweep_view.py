"""What a person sees of a sweep while it lasts: a view that is drawn anew on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Protocol, Self, TextIO

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from types import TracebackType

    from bench.sweep.executor import Done
    from bench.sweep.records import Record
    from bench.sweep.scene_task import Task

_PER_SECOND = 4


class View(Protocol):
    """Somebody who looks on, between entering and leaving."""

    def doing(self, task: Task | None, what: str) -> None:
        """A task has got so far; with None, the sweep as a whole."""
        ...

    def done(self, done: Done) -> None:
        """A task has come to its end."""
        ...

    def judged(self, task: Task, record: Record) -> None:
        """A scene's frames have been judged, or not."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def make_view(stream: TextIO, total: int) -> View:
    """The view that fits where ``stream`` goes; ``total``: how many tasks there are."""
    console = Console(file=stream)
    if stream.isatty() and not console.is_dumb_terminal:
        return Screen(console, total)
    return Lines(stream, total)


class Lines:
    """A line for each scene that is done; for logs."""

    def __init__(self, stream: TextIO, total: int) -> None:
        self._stream = stream
        self._total = total
        self._count = 0

    def doing(self, task: Task | None, what: str) -> None:
        """See View."""
        if task is None:
            self._write(what)

    def done(self, done: Done) -> None:
        """See View."""
        self._count += 1
        self._write(f"[{self._count}/{self._total}] {told(done)}")

    def judged(self, task: Task, record: Record) -> None:
        """See View."""
        self._write(told_judgement(task, record))

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
            return  # nobody reads, or nobody can: the sweep goes on


class Screen:
    """What is being worked on, below a bar; what is done scrolls by."""

    def __init__(self, console: Console, total: int) -> None:
        self._console = console
        self._bar = Progress(
            TextColumn("scenes"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console
        )
        self._all = self._bar.add_task("scenes", total=total)
        self._doing: dict[str, tuple[str, float]] = {}
        self._live = Live(
            get_renderable=self._drawn, console=console, refresh_per_second=_PER_SECOND, transient=True
        )

    def doing(self, task: Task | None, what: str) -> None:
        """See View."""
        if task is None:
            self._console.print(Text(what))
        else:
            self._doing[task.spec.id] = (what, time.monotonic())

    def done(self, done: Done) -> None:
        """See View."""
        self._doing.pop(done.task.spec.id, None)
        self._bar.advance(self._all)
        self._console.print(Text(told(done)))

    def judged(self, task: Task, record: Record) -> None:
        """See View."""
        self._console.print(Text(told_judgement(task, record)))

    def __enter__(self) -> Self:
        self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.__exit__(kind, error, trace)

    def _drawn(self) -> Group:
        rows = Table.grid(padding=(0, 2))
        for scene, (what, since) in sorted(self._doing.items()):
            rows.add_row(
                Text(f"  {scene}"), Text(what), Text(f"{time.monotonic() - since:.0f} s", style="dim")
            )
        return Group(rows, self._bar)


def told(done: Done) -> str:
    """A scene that is done, in one line."""
    scene, record = done.task.spec.id, done.record
    if record is None:
        return f"{scene:<16} could not be done: {plain(done.fault)}"
    audited = record.audited
    if audited is None:
        return f"{scene:<16} {record.produced.outcome if record.produced else 'nothing'}"
    if audited.why is not None:
        return f"{scene:<16} not scored: {plain(audited.why)}"
    frames = len(record.framed.frames) if record.framed is not None else 0
    none = (
        f", no frames: {plain(record.framed.why)}" if record.framed is not None and record.framed.why else ""
    )
    return f"{scene:<16} MPR {share(audited.mpr)}  SPR {share(audited.spr)}  {frames} frames{none}"


def told_judgement(task: Task, record: Record) -> str:
    """A judgement, in one line."""
    judged = record.judged
    if judged is None or judged.why is not None:
        return (
            f"{task.spec.id:<16} not judged: {plain(judged.why if judged and judged.why else 'nothing was')}"
        )
    return f"{task.spec.id:<16} VLM {share(judged.score)}"


def share(value: float | None) -> str:
    """A score, as a person reads it."""
    return "–" if value is None else f"{value:.3f}"


def plain(text: str) -> str:
    """Words of files and servers in one line, without what a terminal would act on."""
    return "".join(char if char.isprintable() else " " for char in text)[:300]
