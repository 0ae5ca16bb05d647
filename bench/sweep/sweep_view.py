"""Shows the progress of a sweep: a live view on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Self

from rich.console import Group
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from simworlds.terminal.console import Console
from simworlds.terminal.lines import is_terminal, write_line
from simworlds.terminal.live_view import LiveView
from simworlds.terminal.text import shortened

if TYPE_CHECKING:
    from types import TracebackType
    from typing import TextIO

    from bench.sweep.executor import FinishedTask
    from bench.sweep.judging import JudgedScene
    from bench.sweep.scene_task import SceneTask

_PER_SECOND = 4
_LONGEST = 300  # characters of a reason


class SweepView:
    """Prints a line for each step that a scene comes to, and for each scene that has ended; for logs."""

    def __init__(self, stream: TextIO, total: int) -> None:
        self._stream = stream
        self._total = total
        self._count = 0

    def doing(self, task: SceneTask | None, what: str) -> None:
        """Shows the progress of a task; with None, of the sweep."""
        self._write(what if task is None else f"{task.spec.id:<16} {what} …")

    def done(self, done: FinishedTask) -> None:
        """Shows a task that has ended."""
        self._count += 1
        self._write(f"[{self._count}/{self._total}] {format_done(done)}")

    def judged(self, scene: JudgedScene) -> None:
        """Shows a scene whose frames were judged, or not."""
        self._write(format_judgement(scene))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None

    def _write(self, line: str) -> None:
        write_line(self._stream, line)


class LiveSweepView(LiveView, SweepView):
    """Shows the running tasks above a progress bar; finished ones scroll by."""

    def __init__(self, console: Console, total: int) -> None:
        self._bar = Progress(
            TextColumn("scenes"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console
        )
        self._all = self._bar.add_task("scenes", total=total)
        self._doing: dict[str, tuple[str, float]] = {}
        LiveView.__init__(self, console, _PER_SECOND, vanishes=True)

    def doing(self, task: SceneTask | None, what: str) -> None:
        """See SweepView."""
        if task is None:
            self._write(what)
        else:
            self._doing[task.spec.id] = (what, time.monotonic())

    def done(self, done: FinishedTask) -> None:
        """See SweepView."""
        self._doing.pop(done.task.spec.id, None)
        self._bar.advance(self._all)
        self._write(format_done(done))

    def draw(self) -> Group:
        """See LiveView."""
        rows = Table.grid(padding=(0, 2))
        for scene, (what, since) in sorted(self._doing.items()):
            rows.add_row(
                Text(f"  {scene}"), Text(what), Text(f"{time.monotonic() - since:.0f} s", style="dim")
            )
        return Group(rows, self._bar)

    def _write(self, line: str) -> None:
        self._console.print(Text(line))


def make_view(stream: TextIO, total: int) -> SweepView:
    """The view that fits ``stream``; ``total``: the number of tasks."""
    return LiveSweepView(Console(stream), total) if is_terminal(stream) else SweepView(stream, total)


def format_done(done: FinishedTask) -> str:
    """Describes a scene that has ended, in one line."""
    scene, record = done.task.spec.id, done.record
    if record is None:
        return f"{scene:<16} could not be done: {reason(done.fault)}"
    audited = record.audited
    if audited is None:
        return f"{scene:<16} {record.produced.outcome if record.produced else 'nothing'}"
    if audited.why is not None:
        return f"{scene:<16} not scored: {reason(audited.why)}"
    framed = record.framed
    frames = len(framed.frames) if framed is not None else 0
    none = f", no frames: {reason(framed.why)}" if framed is not None and framed.why else ""
    return f"{scene:<16} MPR {share(audited.mpr)}  SPR {share(audited.spr)}  {frames} frames{none}"


def format_judgement(scene: JudgedScene) -> str:
    """Describes a judgement in one line."""
    judged, name = scene.record.judged, f"{scene.task.spec.id:<16}"
    if judged is None or judged.why is not None:
        why = reason(judged.why if judged and judged.why else "no judgement")
        return f"{name} not judged: {why}"
    if scene.stands:
        by = f"{judged.provider}/{judged.model}"
        return f"{name} not judged: {reason(scene.stands)}; VLM {share(judged.score)} of {by} stays"
    return f"{name} VLM {share(judged.score)}"


def share(value: float | None) -> str:
    """Formats a score."""
    return "–" if value is None else f"{value:.3f}"


def reason(text: str) -> str:
    """Untrusted text in one short line, without control characters."""
    return shortened(text, _LONGEST)
