"""Does tasks on this machine, each in a process of its own: what befalls one costs only that one.

Ctrl-C reaches the sweep alone, which ends its processes; these end what they have started. Where the system offers it,
they end with the sweep whatever ends that.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NoReturn, Protocol

from bench.sweep.records import Record
from bench.sweep.scene_task import do_scene
from simworlds.end_with_parent import end_with_parent

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess
    from types import FrameType

    from bench.sweep.scene_task import Task

_END_SECONDS = 40.0  # for a process that was asked to end


@dataclass(frozen=True, slots=True)
class Done:
    """A task that has come to its end: its record, or ``fault`` in words, which is no result."""

    task: Task
    record: Record | None
    fault: str = ""


class Crew(Protocol):
    """Whoever does tasks."""

    def work(self, tasks: Sequence[Task], tell: Callable[[Task | None, str], None]) -> Generator[Done]:
        """Does all of them; gives each when it is done.

        ``tell`` hears what is being done for which task; with None, for the whole. When the caller closes the
        generator, or KeyboardInterrupt goes through it, nothing goes on.
        """
        ...


@dataclass(frozen=True, slots=True)
class LocalCrew:
    """As many tasks at a time as there are ``jobs``."""

    jobs: int = 1

    def work(self, tasks: Sequence[Task], tell: Callable[[Task | None, str], None]) -> Generator[Done]:
        """See Crew."""
        waiting = list(reversed(tasks))
        working: dict[Connection, _Worker] = {}
        try:
            while waiting or working:
                while waiting and len(working) < self.jobs:
                    worker = _Worker(waiting.pop())
                    working[worker.pipe] = worker
                for pipe in wait(list(working)):
                    worker = working[pipe]  # type: ignore[index]
                    done = worker.heard(tell)
                    if done is not None:
                        del working[worker.pipe]
                        yield done
        finally:
            _end(list(working.values()))


class _Worker:
    """A process with one task."""

    def __init__(self, task: Task) -> None:
        context = multiprocessing.get_context("spawn")
        self.task = task
        self.pipe, theirs = context.Pipe(duplex=False)
        self.process: SpawnProcess = context.Process(
            target=_work, args=(task, theirs, os.getpid()), name=task.spec.id
        )
        with _without_interrupts():
            self.process.start()
        theirs.close()

    def heard(self, tell: Callable[[Task | None, str], None]) -> Done | None:
        """The end of the task, if that is what there is to hear."""
        try:
            kind, value = self.pipe.recv()
        except EOFError:
            self.process.join()
            return self._ended(None, f"its process ended ({_ending(self.process.exitcode)})")
        except Exception:  # half a message, of a process that was killed over it
            return self._ended(None, "its process sent what is no message")
        if kind == "doing":
            tell(self.task, str(value))
            return None
        return self._ended(value, "") if kind == "record" else self._ended(None, str(value))

    def _ended(self, record: Any, fault: str) -> Done:
        self.process.join(_END_SECONDS)
        self.process.kill()
        self.process.join()
        self.pipe.close()
        return Done(self.task, record if isinstance(record, Record) else None, fault)


@contextmanager
def _without_interrupts() -> Generator[None]:
    """A process that is started meanwhile hears of no Ctrl-C; this one hears of it afterwards."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _ending(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            return signal.Signals(-code).name
    return f"exit code {code}"


def _end(workers: list[_Worker]) -> None:
    """Asks them to end, which lets them end what they have started; those that do not, at once."""
    for worker in workers:
        worker.process.terminate()
    try:
        for worker in workers:
            worker.process.join(_END_SECONDS)
    finally:
        for worker in workers:
            worker.process.kill()
            worker.process.join()
            worker.pipe.close()


# In the other process


def _work(task: Task, pipe: Connection, parent: int) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    signal.signal(signal.SIGTERM, _interrupt)
    end_with_parent(parent, signal.SIGTERM)

    def tell(doing: str) -> None:
        with suppress(OSError):
            pipe.send(("doing", doing))

    try:
        message = ("record", do_scene(task, tell))
    except KeyboardInterrupt:
        sys.exit(130)
    except Exception as error:  # whatever it is, the other scenes go on
        said = " ".join(str(error).split())
        message = ("fault", f"{type(error).__name__}: {said}" if said else type(error).__name__)
    with suppress(OSError):
        pipe.send(message)


def _interrupt(_number: int, _frame: FrameType | None) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt
