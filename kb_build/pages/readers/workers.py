"""Reads pages in processes of their own, each page within a budget of time and memory.

A page may be anything. What it can make a parser do is bounded by the system: the timers and the limit on memory are
set anew before each page, and end the process that exceeds them. What happens then costs that page alone. It is given
up when it fails as the first one that a process reads, so that no page pays for those before it.
"""

from __future__ import annotations

import contextlib
import gc
import multiprocessing
import os
import pickle
import resource
import signal
import sys
from collections import deque
from dataclasses import dataclass, field
from math import sqrt
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, Final

from kb_build.errors import SourceError
from simworlds.end_with_parent import end_with_parent
from simworlds.errors import UserError
from simworlds.processes import describe_exit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess

    from kb_build.pages.page import Page

_BATCH: Final = 10
_LARGER_BATCH: Final = 60
_DEEPEST: Final = 1_000
_NO_MEMORY: Final = 77
_NO_ANSWER: Final = 78
_MEMORY = "/proc/self/statm"
_PAGE = resource.getpagesize()


@dataclass(frozen=True, slots=True)
class PageBudget:
    """What the reading of one page may take. The slowest page of the real manual takes a second and 50 MB.

    ``cpu_seconds`` of its process, ``seconds`` by the clock, ``memory`` (bytes of address space beyond what the process
    had), ``answer`` (bytes of what was read; ``gathered`` for a process), ``written`` (bytes of one file). All pages
    together have ``cpu_seconds_in_all`` and ``cpu_seconds_each`` for every page.
    """

    cpu_seconds: float = 10
    seconds: float = 120
    memory: int = 1 << 30
    answer: int = 4 << 20
    gathered: int = 256 << 20
    written: int = 256 << 20
    cpu_seconds_in_all: float = 120
    cpu_seconds_each: float = 0.25

    def for_all(self, pages: int) -> float:
        """CPU seconds that so many pages may take together."""
        return self.cpu_seconds_in_all + self.cpu_seconds_each * pages


@dataclass(slots=True)
class ReadPages:
    """``answers`` by page, in the order in which they came; ``failed``: page → why it could not be read."""

    answers: dict[str, Any] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PageWork:
    """What a process does: ``read`` each page, and in the end ``gather`` what it holds of them all.

    With ``gather``, answers count when ``merge`` has been given the pages' names and what was gathered of them; a
    process that fails before has read its pages in vain.
    """

    read: Callable[[str], Any]
    gather: Callable[[], Any] | None = None
    merge: Callable[[Sequence[str], Any], None] | None = None
    done: Callable[[str], None] | None = None


def read_apart(names: Sequence[str], work: PageWork, *, jobs: int, budget: PageBudget) -> ReadPages:
    """Reads pages in up to ``jobs`` processes at a time, forked from this one, which must have no other threads.

    Raises SourceError when reading a page raises it. Whatever else happens to a page is its reason to fail.
    """
    readers = _Readers(work, max(1, jobs), budget, budget.for_all(len(names)) + _cpu_of_children())
    return readers.run(names)


def read_elsewhere(read: Callable[..., list[Page]], **given: Any) -> list[Page]:
    """Runs one of the two functions that read pages in a fresh interpreter, for a process with threads: what is forked
    from it may hang. ``given``: the arguments by name. Raises UserError as the function does."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe(duplex=False)
    progress = given.pop("progress")
    process = context.Process(target=_serve, args=(read, given, theirs, os.getpid()))
    process.start()
    theirs.close()
    try:
        while True:
            kind, answer = ours.recv()
            if kind == "failed":
                raise answer
            if kind == "read":
                return answer
            if progress is not None:
                progress(*answer)
    except EOFError:
        process.join()
        ended = describe_exit(process.exitcode or 0)
        raise SourceError(f"the process that read the pages did not survive: {ended}") from None
    finally:
        process.kill()
        process.join()
        ours.close()


def _serve(read: Callable[..., list[Page]], given: dict[str, Any], answers: Connection, parent: int) -> None:
    end_with_parent(parent)

    def report(done: int, total: int) -> None:
        answers.send(("progress", (done, total)))

    try:
        pages = read(**given, progress=report)
    except UserError as error:
        answers.send(("failed", error))
    else:
        answers.send(("read", pages))


@dataclass(slots=True)
class _Reader:
    """A process, and how far it is."""

    names: Sequence[str]
    process: ForkProcess
    done: list[tuple[str, Any]] = field(default_factory=list)
    complete: bool = False


@dataclass(slots=True)
class _Readers:
    work: PageWork
    jobs: int
    budget: PageBudget
    deadline: float
    pages: ReadPages = field(default_factory=ReadPages)
    waiting: deque[Sequence[str]] = field(default_factory=deque)
    running: dict[Connection, _Reader] = field(default_factory=dict)

    def run(self, names: Sequence[str]) -> ReadPages:
        # Where each page is answered at once, a process that fails has read none of the others in vain.
        batch = _BATCH if self.work.gather else _LARGER_BATCH
        self.waiting.extend(_chunks(names, self.jobs, batch))
        try:
            while self.waiting or self.running:
                if self.waiting and len(self.running) < self.jobs:
                    self._start(self.waiting.popleft())
                    continue
                for connection in wait(list(self.running)):
                    self._receive(connection)
        finally:
            for connection, reader in self.running.items():
                reader.process.kill()
                reader.process.join()
                connection.close()
        return self.pages

    def _start(self, names: Sequence[str]) -> None:
        if _cpu_of_children() > self.deadline:
            for name in names:
                self._fail(name, "other pages took the time that there is for all")
            return
        context = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe(duplex=False)
        process = context.Process(
            target=_read_some, args=(names, self.work, self.budget, theirs, os.getpid())
        )
        process.start()
        theirs.close()
        self.running[ours] = _Reader(names, process)

    def _receive(self, connection: Any) -> None:
        reader = self.running[connection]
        try:
            kind, answer = connection.recv()
        except (EOFError, OSError):
            del self.running[connection]
            connection.close()
            reader.process.join()
            if not reader.complete:
                self._lost(reader)
            return
        match kind:
            case "gathered":
                assert self.work.merge is not None
                kept = [name for name, _ in reader.done if name not in self.pages.failed]
                self.work.merge(kept, answer)
                self.pages.answers.update((name, page) for name, page in reader.done if name in set(kept))
                reader.complete = True
            case "stop":
                raise SourceError(answer)
            case _:
                self._answered(reader, kind, answer)

    def _answered(self, reader: _Reader, kind: str, answer: Any) -> None:
        name = reader.names[len(reader.done)]
        reader.done.append((name, answer))
        if kind == "failed":
            self._fail(name, answer)
            return
        if self.work.gather is None:
            self.pages.answers[name] = answer
            reader.complete = len(reader.done) == len(reader.names)
        if self.work.done:
            self.work.done(name)

    def _lost(self, reader: _Reader) -> None:
        """A process ended before it was done: its pages are divided anew."""
        reason = self._reason(reader.process.exitcode or 0)
        at = len(reader.done)
        before = (
            [] if self.work.gather is None else [n for n in reader.names[:at] if n not in self.pages.failed]
        )
        if at == len(reader.names):  # it could not tell what it had read
            if len(before) == 1:
                self._fail(before[0], reason)
                return
            half = len(before) // 2
            parts = [before[:half], before[half:]]
        elif at == 0:
            self._fail(reader.names[0], reason)
            parts = [reader.names[1:]]
        else:
            parts = [before, reader.names[at : at + 1], reader.names[at + 1 :]]
        self.waiting.extend(part for part in parts if part)

    def _fail(self, name: str, reason: str) -> None:
        self.pages.failed[name] = reason
        if self.work.done:
            self.work.done(name)

    def _reason(self, code: int) -> str:
        budget = self.budget
        reasons = {
            -signal.SIGPROF: f"it took more than {budget.cpu_seconds:g} s of computing",
            -signal.SIGALRM: f"it took more than {budget.seconds:g} s",
            _NO_MEMORY: f"it took more than {budget.memory >> 20:,} MiB of memory",
            _NO_ANSWER: "what was read of it is too large",
        }
        return reasons.get(code, f"the process that read it did not survive: {describe_exit(code)}")


def _chunks(names: Sequence[str], jobs: int, batch: int) -> list[Sequence[str]]:
    """Shares that are large enough for a process each, and small enough for all processes to end together."""
    size = len(names) // jobs
    size = int(sqrt(len(names) / jobs * batch)) if size >= batch else max(1, size)
    return [names[at : at + size] for at in range(0, len(names), size)]


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


# In the process that reads ----------------------------------------------------------------------------------


def _read_some(
    names: Sequence[str], work: PageWork, budget: PageBudget, answers: Connection, parent: int
) -> None:
    end_with_parent(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, which ends this process
    for number in (signal.SIGPROF, signal.SIGALRM):
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGPROF, signal.SIGALRM})
    gc.freeze()  # looking through what was here before would copy it
    with contextlib.suppress(RecursionError):
        sys.setrecursionlimit(_DEEPEST)  # whoever calls may have raised it
    _lower(resource.RLIMIT_CORE, 0)
    _lower(resource.RLIMIT_FSIZE, budget.written)
    had = _address_space()
    with contextlib.suppress(BrokenPipeError):
        for name in names:
            _grant(budget, had)
            _send(answers, _answer(work, name), budget.answer)
        if work.gather is not None:
            _grant(budget, had)
            _send(answers, ("gathered", work.gather()), budget.gathered)


def _answer(work: PageWork, name: str) -> tuple[str, Any]:
    try:
        return "read", work.read(name)
    except MemoryError:
        os._exit(_NO_MEMORY)
    except SourceError as error:
        return "stop", str(error)
    except Exception as error:  # one page must not take 2,000 others with it
        return "failed", reason_of(error)


def reason_of(error: BaseException) -> str:
    """An exception as a warning tells it: its kind and its message's first line."""
    return f"{type(error).__name__}: {error}".splitlines()[0][:200]


def _send(answers: Connection, answer: tuple[str, Any], most: int) -> None:
    try:
        data = pickle.dumps(answer, pickle.HIGHEST_PROTOCOL)
    except MemoryError:
        os._exit(_NO_MEMORY)
    except Exception:
        os._exit(_NO_ANSWER)
    if len(data) > most:
        os._exit(_NO_ANSWER)
    signal.setitimer(signal.ITIMER_REAL, 0)  # whoever receives it may be busy
    answers.send_bytes(data)


def _grant(budget: PageBudget, had: int) -> None:
    """Gives the next page its budget. ``had``: address space at the start."""
    has = _address_space()
    if has > had + budget.memory // 2:
        gc.collect()
        has = _address_space()
    # Beyond what a few pages may leave behind, the process pays: its pages are then read by others.
    _lower(
        resource.RLIMIT_AS,
        min(has + budget.memory, had + 2 * budget.memory) if has else resource.RLIM_INFINITY,
    )
    signal.setitimer(signal.ITIMER_PROF, budget.cpu_seconds)
    signal.setitimer(signal.ITIMER_REAL, budget.seconds)


def _lower(which: int, limit: int) -> None:
    """Sets a limit as far as the user's own allows it."""
    _, most = resource.getrlimit(which)
    if most != resource.RLIM_INFINITY:
        limit = most if limit == resource.RLIM_INFINITY else min(limit, most)
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(which, (limit, most))


def _address_space() -> int:
    """In bytes; 0 where the system does not tell (only Linux holds to a limit on it)."""
    try:
        file = os.open(_MEMORY, os.O_RDONLY)
    except OSError:
        return 0
    try:
        return int(os.read(file, 100).split()[0]) * _PAGE
    finally:
        os.close(file)
