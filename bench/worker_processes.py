"""Runs tasks on this machine, each in a process of its own: a crash costs only one task.

Only the first process gets Ctrl-C; it ends the others, which end what they have started. On Linux they also end when
the first one is killed.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from simworlds.end_with_parent import end_with_parent
from simworlds.processes import signal_name
from simworlds.terminal.streams import guard_streams

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess
    from types import FrameType

_Task = TypeVar("_Task")
_Result = TypeVar("_Result")
_END_SECONDS = 40.0  # that a process has to end by itself


def run_in_processes(
    tasks: Sequence[_Task],
    function: Callable[[_Task, Callable[[str], None]], _Result],
    jobs: int,
    tell: Callable[[_Task, str], None],
) -> Generator[tuple[_Task, _Result | None, str]]:
    """Calls ``function(task, tell)`` for each task, in ``jobs`` processes at a time. All must be picklable.

    Yields (task, result, "") when a task has ended, or (task, None, fault in words) when it has raised or crashed.
    ``tell`` is called with the progress of a task. All processes end when the caller closes the generator or
    KeyboardInterrupt passes through it.
    """
    waiting = list(reversed(tasks))
    working: dict[Connection, _Worker] = {}
    try:
        while waiting or working:
            while waiting and len(working) < jobs:
                worker = _Worker(function, waiting.pop())
                working[worker.pipe] = worker
            for pipe in wait(list(working)):
                worker = working[pipe]  # type: ignore[index]
                kind, value = worker.receive()
                if kind == "doing":
                    tell(worker.task, value)
                    continue
                del working[worker.pipe]
                worker.end()
                yield (worker.task, value, "") if kind == "result" else (worker.task, None, value)
    finally:
        _end(list(working.values()))


class _Worker:
    """A process with one task."""

    def __init__(self, function: Callable[..., Any], task: Any) -> None:
        context = multiprocessing.get_context("spawn")
        self.task = task
        self.pipe, theirs = context.Pipe(duplex=False)
        self.process: SpawnProcess = context.Process(target=_work, args=(function, task, theirs, os.getpid()))
        with _without_interrupts():
            self.process.start()
        theirs.close()

    def receive(self) -> tuple[str, Any]:
        """("doing", progress), ("result", result) or ("fault", reason)."""
        try:
            return self.pipe.recv()
        except EOFError:
            self.process.join()
            code = self.process.exitcode
            how = f"exit code {code}" if code is None or code >= 0 else signal_name(code)
            return "fault", f"its process ended without a result ({how})"
        except Exception:  # half a message, of a process that was killed over it
            return "fault", "its process sent an invalid message"

    def end(self, seconds: float = _END_SECONDS) -> None:
        """Waits for the process to end; then kills it."""
        try:
            self.process.join(seconds)
        finally:
            self.process.kill()
            self.process.join()
            self.pipe.close()


@contextmanager
def _without_interrupts() -> Generator[None]:
    """Blocks Ctrl-C: processes started meanwhile do not get it; this process gets it afterwards."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end(workers: list[_Worker]) -> None:
    """Asks processes to end, so that they can end what they have started; kills those that do not."""
    for worker in workers:
        worker.process.terminate()
    try:
        for worker in workers:
            worker.process.join(_END_SECONDS)
    finally:
        for worker in workers:
            worker.end(0.0)


# In the other process


def _work(function: Callable[..., Any], task: Any, pipe: Connection, parent: int) -> None:
    guard_streams()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    signal.signal(signal.SIGTERM, _interrupt)
    end_with_parent(parent, signal.SIGTERM)

    def tell(doing: str) -> None:
        with suppress(OSError):
            pipe.send(("doing", doing))

    try:
        message = ("result", function(task, tell))
    except KeyboardInterrupt:
        sys.exit(130)
    except Exception as error:  # whatever it is, the other tasks go on
        text = " ".join(str(error).split())
        message = ("fault", f"{type(error).__name__}: {text}" if text else type(error).__name__)
    with suppress(OSError):
        pipe.send(message)


def _interrupt(_number: int, _frame: FrameType | None) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt
