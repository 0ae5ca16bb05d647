"""A process as it is seen from outside: what it uses, which threads work in it; and how it is stopped meanwhile.

All of it is what the kernel says: code in the process cannot patch that.
"""

from __future__ import annotations

import os
import re
import signal
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator

_GRACE_SECONDS = 0.5
_LOOK_SECONDS = 0.005
# A thread of a pool that has nothing to do waits here; code that waits for time, a file or a pipe waits elsewhere.
_IDLE_PLACES = frozenset({"futex_wait_queue", "futex_wait_queue_me", "futex_do_wait", "", "0"})
_IDLE_CALLS = frozenset({"202", "98", "449", "455"})  # futex, futex_waitv, futex_wait on x86_64 and aarch64
_USED = re.compile(rb"^(RssAnon|RssShmem|Threads):\s+(\d+)", re.MULTILINE)
_RESUMED = frozenset({"219", "128"})  # restart_syscall: waits on after it was stopped, whatever it waited for


class WatchedProcess:
    """The process of this number; 0: none, of which everything is 0. It must run, so that the number is still its own.

    Without descriptors for processes (another system than Linux), nothing is stopped.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self._descriptor = -1
        self._paused = False
        if number and hasattr(os, "pidfd_open"):
            with suppress(OSError):
                # By descriptor, since the number of a process that has ended may soon be another's.
                self._descriptor = os.pidfd_open(number)
        self._known = self._tasks()

    def memory_and_threads(self) -> tuple[int, int]:
        """(bytes of memory not backed by a file, number of threads); 0 where that cannot be known."""
        values = dict(_USED.findall(self._status()))
        try:
            return (int(values[b"RssAnon"]) + int(values[b"RssShmem"])) * 1024, int(values[b"Threads"])
        except LookupError:
            return 0, 0

    # Standing still

    def pause(self) -> None:
        """Stops all its threads."""
        self._paused = True
        self._signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """Lets it run again."""
        self._paused = False
        self._signal(signal.SIGCONT)

    @contextmanager
    def standing_still(self) -> Generator[None]:
        """Stops the process meanwhile, unless it is stopped already."""
        if self._paused or b"\nState:\tT" in self._status():
            yield
            return
        self.pause()
        try:
            yield
        finally:
            self.go_on()

    def close(self) -> None:
        """Forgets the process."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    # Threads

    def mark(self) -> None:
        """Threads that there are now are its own."""
        self._known = self._tasks()

    def has_new_threads(self) -> bool:
        """Whether threads that began since ``mark`` are there, whatever they do."""
        return not self._tasks() <= self._known

    def threads_left(self) -> int:
        """How many threads that began since ``mark`` still do something, after a grace period. The process must run."""
        deadline = time.monotonic() + _GRACE_SECONDS
        while left := [task for task in self._tasks() - self._known if self._works(task)]:
            if time.monotonic() > deadline:
                return len(left)
            time.sleep(_LOOK_SECONDS)
        return 0

    def _works(self, task: str) -> bool:
        folder = Path(f"/proc/{self.number}/task/{task}")
        try:
            state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
            if state != "S":
                return state not in "XZ"
            with suppress(PermissionError):
                number = (folder / "syscall").read_text().split()[0]
                if number not in _RESUMED:
                    return number not in _IDLE_CALLS
            return (folder / "wchan").read_text() not in _IDLE_PLACES
        except (OSError, IndexError):
            return False

    def _tasks(self) -> frozenset[str]:
        try:
            return frozenset(os.listdir(f"/proc/{self.number}/task") if self.number else ())  # noqa: PTH208 - names
        except OSError:
            return frozenset()

    def _signal(self, number: int) -> None:
        if self._descriptor >= 0:
            with suppress(OSError):
                signal.pidfd_send_signal(self._descriptor, number)

    def _status(self) -> bytes:
        """What the kernel says of it, a line each; nothing if there is no such process."""
        if not self.number:
            return b""
        try:
            with open(f"/proc/{self.number}/status", "rb", buffering=0) as file:  # noqa: PTH123 - many times a second
                return file.read()
        except OSError:
            return b""


def innermost_process(process: int) -> int:
    """The last of the chain of child processes of this one: Blender itself, behind what started it."""
    for _ in range(8):
        try:
            children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
        except OSError:
            return process
        if not children:
            return process
        process = int(children[0])
    return process
