"""Work in a forked process that cannot outlive this one."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import threading
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from simworlds.end_with_parent import end_with_parent
from simworlds.errors import UserError
from simworlds.processes import kill_group

if TYPE_CHECKING:
    from collections.abc import Generator
    from multiprocessing.connection import Connection

_T = TypeVar("_T")
Work = Callable[["Connection"], None]


def can_fork() -> bool:
    """Whether a process can be forked safely: a child forked while other threads hold locks may hang."""
    return os.name == "posix" and threading.active_count() == 1


@contextlib.contextmanager
def forked(work: Work) -> Generator[Connection]:
    """Runs ``work`` in a forked process; gives the end of the pipe to which it sends, where EOF means it died.

    The process and all that it started are killed when the body ends, and when this process is killed. Raises OSError
    where none can be started: too little memory, too many processes or open files.
    """
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(work, theirs, ours, os.getpid()))
    with ours:
        with theirs:
            process.start()
        try:
            yield ours
        finally:
            process.kill()
            if process.pid is not None:
                kill_group(process.pid)
            process.join()


def _run(work: Work, messages: Connection, theirs: Connection, parent: int) -> None:
    os.setsid()  # Ctrl-C reaches the parent alone, which ends the whole group
    os.register_at_fork(after_in_child=lambda: end_with_parent(os.getppid()))
    end_with_parent(parent)
    theirs.close()
    with contextlib.suppress(BrokenPipeError):
        work(messages)


@contextlib.contextmanager
def beside(function: Callable[[], _T]) -> Generator[Callable[[], _T]]:
    """Computes ``function()`` in another process meanwhile; gives a function that waits for the result.

    What cannot be computed there (no fork, not enough memory, …) is computed here when it is asked for. A
    UserError is raised here, too.
    """

    def work(messages: Connection) -> None:
        outcome: Any
        try:
            outcome = ("result", function())
        except UserError as error:
            outcome = ("error", error)
        messages.send(outcome)

    with contextlib.ExitStack() as stack:
        try:
            messages = stack.enter_context(forked(work)) if can_fork() else None
        except OSError:
            messages = None
        yield function if messages is None else partial(_received, messages, function)


def _received(messages: Connection, function: Callable[[], _T]) -> _T:
    try:
        kind, outcome = messages.recv()
    except EOFError:
        return function()
    if kind == "error":
        raise outcome
    return outcome
