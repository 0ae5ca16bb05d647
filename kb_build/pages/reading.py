"""Reads pages in a process of its own, while this one extracts the API from Blender."""

from __future__ import annotations

import contextlib
import tempfile
import time
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from kb_build.errors import SourceError
from kb_build.pages.page_cache import kept_pages, read_pages
from simworlds.errors import UserError, remedy
from simworlds.files import remove_leftovers, scratch_folder
from simworlds.forked import can_fork, forked

if TYPE_CHECKING:
    from collections.abc import Sequence
    from multiprocessing.connection import Connection
    from pathlib import Path
    from types import TracebackType

    from kb_build.pages.page import Page
    from kb_build.pages.sources import DocumentationSource
    from simworlds.terminal.progress import Progress

_REPORT_SECONDS = 0.1


class PageReader:
    """Context manager: starts reading what is not cached; leaves no process behind.

    Where a process cannot be forked safely, the pages are read by :meth:`result` instead.
    """

    def __init__(
        self, sources: Sequence[DocumentationSource], cache: Path, *, jobs: int, progress: Progress
    ) -> None:
        self._sources = sources
        self._cache = cache
        self._jobs = jobs
        self._progress = progress
        self._pages: dict[str, list[Page]] = {}
        self._messages: Connection | None = None
        self._cleanup = contextlib.ExitStack()

    def __enter__(self) -> PageReader:
        remove_leftovers(self._cache / "scratch")
        for source in self._sources:
            kept = kept_pages(source, self._cache)
            if kept is not None:
                self._pages[source.role] = kept
        if self._unread and can_fork():
            job = _Job(self._unread, self._cache, self._jobs, self._scratch())
            with contextlib.suppress(OSError):  # where no process can be started, pages are read here
                self._messages = self._cleanup.enter_context(forked(partial(_work, job)))
        return self

    @property
    def _unread(self) -> list[DocumentationSource]:
        return [source for source in self._sources if source.role not in self._pages]

    def _scratch(self) -> Path:
        """Where the other process keeps what it cannot remove when it is killed."""
        try:
            return self._cleanup.enter_context(scratch_folder(self._cache / "scratch"))
        except OSError as error:
            raise SourceError(
                f"{self._cache} cannot be written: {error}. {remedy(error)}, or set SIMWORLDS_HOME to another folder"
            ) from error

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
                raise SourceError(
                    "the process that read the pages was killed before it was done; if memory is scarce, "
                    "try --jobs 1"
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


@dataclass(frozen=True, slots=True)
class _Job:
    sources: Sequence[DocumentationSource]
    cache: Path
    processes: int
    scratch: Path


def _work(job: _Job, messages: Connection) -> None:
    """The other process: reads and caches pages, and reports its progress."""
    tempfile.tempdir = str(job.scratch)
    last = 0.0

    def report(label: str, done: int, total: int | None, /) -> None:
        nonlocal last
        if done in {0, total} or time.monotonic() - last > _REPORT_SECONDS:
            last = time.monotonic()
            messages.send(("progress", label, done, total))

    outcome = ("done",)
    try:
        for source in job.sources:
            read_pages(source, job.cache, jobs=job.processes, progress=report)
    except UserError as error:
        outcome = ("failed", str(error))
    except Exception as error:
        outcome = ("failed", f"pages could not be read: {type(error).__name__}: {error}")
    messages.send(outcome)
