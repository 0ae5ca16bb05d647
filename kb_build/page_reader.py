"""Pages are read in a process of their own, while this one asks Blender and reads its answer."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kb_build.errors import KBBuildError, SourceError
from kb_build.page_files import kept_pages, read_pages
from kb_build.staging import scratch_folder

if TYPE_CHECKING:
    from collections.abc import Sequence
    from multiprocessing.connection import Connection
    from pathlib import Path
    from types import TracebackType

    from kb_build.progress import Progress
    from kb_build.records import Page
    from kb_build.sources import Source

_REPORT_SECONDS = 0.1
_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of <linux/prctl.h>


class PageReader:
    """Context manager: starts reading what is not kept already; nothing of it is left running afterwards.

    Where a process cannot be forked safely, the pages are read by :meth:`result` instead.
    """

    def __init__(self, sources: Sequence[Source], cache: Path, *, jobs: int, progress: Progress) -> None:
        self._sources = sources
        self._cache = cache
        self._jobs = jobs
        self._progress = progress
        self._pages: dict[str, list[Page]] = {}
        self._process: Any = None
        self._messages: Connection | None = None
        self._cleanup = contextlib.ExitStack()

    def __enter__(self) -> PageReader:
        for source in self._sources:
            kept = kept_pages(source, self._cache)
            if kept is not None:
                self._pages[source.role] = kept
        if self._unread and os.name == "posix" and threading.active_count() == 1:
            scratch = self._scratch()
            context = multiprocessing.get_context("fork")
            self._messages, theirs = context.Pipe(duplex=False)
            self._process = context.Process(
                target=_work,
                args=(
                    _Job(self._unread, self._cache, self._jobs, os.getpid(), scratch),
                    theirs,
                    self._messages,
                ),
            )
            self._process.start()
            self._cleanup.callback(self._stop)
            theirs.close()
        return self

    @property
    def _unread(self) -> list[Source]:
        return [source for source in self._sources if source.role not in self._pages]

    def result(self) -> dict[str, list[Page]]:
        """The pages by role. Raises SourceError when a source cannot be read."""
        if self._messages is not None:
            self._receive(self._messages)
        for source in self._unread:
            kept = kept_pages(source, self._cache)
            self._pages[source.role] = kept or read_pages(
                source, self._cache, jobs=self._jobs, progress=self._progress
            )
        return self._pages

    def _receive(self, messages: Connection) -> None:
        """Shows the other process' progress until it is done; its pages are in the files by then."""
        while True:
            try:
                message = messages.recv()
            except EOFError:
                self._process.join()
                code = self._process.exitcode
                raise SourceError(
                    f"the process that read the pages ended before it was done (exit code {code}); if "
                    "memory is scarce, try --jobs 1"
                ) from None
            match message:
                case ("progress", label, done, total):
                    self._progress(label, done, total)
                case ("failed", text):
                    raise SourceError(text)
                case _:
                    return

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._cleanup.close()

    def _scratch(self) -> Path:
        """Where the other process keeps what it cannot remove when it is killed."""
        try:
            return self._cleanup.enter_context(scratch_folder(self._cache / "scratch"))
        except OSError as error:
            raise SourceError(
                f"{self._cache} cannot be written: {error}; make room there, or set SIMWORLDS_HOME"
            ) from error

    def _stop(self) -> None:
        self._process.kill()
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.join()
        if self._messages is not None:
            self._messages.close()


@dataclass(frozen=True, slots=True)
class _Job:
    sources: Sequence[Source]
    cache: Path
    processes: int
    parent: int
    scratch: Path


def _work(job: _Job, messages: Connection, theirs: Connection) -> None:
    """The other process: reads, keeps, tells how far it is."""
    os.setsid()  # Ctrl-C reaches the parent alone, which ends the whole group
    os.register_at_fork(after_in_child=_die_with_parent)
    _die_with_parent()
    theirs.close()
    tempfile.tempdir = str(job.scratch)
    last = 0.0

    def report(label: str, done: int, total: int | None, /) -> None:
        nonlocal last
        if done in {0, total} or time.monotonic() - last > _REPORT_SECONDS:
            last = time.monotonic()
            messages.send(("progress", label, done, total))

    outcome = ("done",)
    try:
        if os.getppid() != job.parent:
            return
        for source in job.sources:
            read_pages(source, job.cache, jobs=job.processes, progress=report)
    except KBBuildError as error:
        outcome = ("failed", str(error))
    except Exception as error:
        outcome = ("failed", f"pages could not be read: {type(error).__name__}: {error}")
    with contextlib.suppress(OSError):  # nobody listens when the parent is gone
        messages.send(outcome)


def _die_with_parent() -> None:
    """Where the system offers it, end this process when the one that started it is killed."""
    if sys.platform != "linux":
        return
    import ctypes  # noqa: PLC0415 - in the other process only

    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)
