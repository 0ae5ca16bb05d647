"""Work in a forked process that cannot outlive this one."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from kb_build.errors import KBBuildError

if TYPE_CHECKING:
    from collections.abc import Generator
    from multiprocessing.connection import Connection

_T = TypeVar("_T")
Work = Callable[["Connection"], None]
_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of <linux/prctl.h>


def can_fork() -> bool:
    """Whether a process can be forked safely: a child forked while other threads hold locks may hang."""
    return os.name == "posix" and threading.active_count() == 1


@contextlib.contextmanager
def forked(work: Work) -> Generator[Connection]:
    """Runs ``work`` in a forked process; gives the end of the pipe to which it sends, where EOF means it died.

    The process and all that it started are killed when the body ends, and when this process is killed.
    """
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(work, theirs, ours, os.getpid()))
    process.start()
    try:
        theirs.close()
        yield ours
    finally:
        process.kill()
        if process.pid is not None:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
        process.join()
        ours.close()


def _run(work: Work, messages: Connection, theirs: Connection, parent: int) -> None:
    os.setsid()  # Ctrl-C reaches the parent alone, which ends the whole group
    os.register_at_fork(after_in_child=_die_with_parent)
    _die_with_parent()
    theirs.close()
    with contextlib.suppress(BrokenPipeError):
        if os.getppid() == parent:
            work(messages)


def _die_with_parent() -> None:
    """Where the system offers it, end this process when the one that started it is killed."""
    if sys.platform != "linux":
        return
    import ctypes  # noqa: PLC0415 - in the other process only

    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)


@contextlib.contextmanager
def beside(function: Callable[[], _T]) -> Generator[Callable[[], _T]]:
    """Computes ``function()`` in another process meanwhile; gives a function that waits for the result.

    What cannot be computed there (no fork, not enough memory, …) is computed here when it is asked for. A
    KBBuildError is raised here, too.
    """

    def work(messages: Connection) -> None:
        outcome: Any
        try:
            outcome = ("result", function())
        except KBBuildError as error:
            outcome = ("error", error)
        messages.send(outcome)

    if not can_fork():
        yield function
        return
    with forked(work) as messages:

        def result() -> _T:
            try:
                kind, outcome = messages.recv()
            except EOFError:
                return function()
            if kind == "error":
                raise outcome
            return outcome

        yield result
