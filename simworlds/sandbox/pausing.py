"""Stops and continues a process from outside, and counts the threads that code has left running in it.

Both by what the kernel says of it: code in the process cannot patch that.
"""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from pathlib import Path

_GRACE_SECONDS = 0.5
_LOOK_SECONDS = 0.005
# A thread of a pool that has nothing to do waits here; code that waits for time, a file or a pipe waits elsewhere.
_IDLE = frozenset({"futex", "futex_wait_queue", "futex_wait_queue_me", "futex_do_wait"})
_FUTEX_NUMBERS = frozenset(
    {"202", "98", "449", "455"}
)  # futex, futex_waitv, futex_wait, on x86_64 and aarch64


class PausableProcess:
    """A process by its number; 0 for none. On systems without pidfds nothing is stopped."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self._descriptor = -1
        if pid and hasattr(os, "pidfd_open"):
            with suppress(OSError):
                self._descriptor = os.pidfd_open(pid)
        self._known = self._tasks()

    def pause(self) -> None:
        """Stops all its threads."""
        self._signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """Lets it run."""
        self._signal(signal.SIGCONT)

    def mark(self) -> None:
        """Threads that there are now are its own."""
        self._known = self._tasks()

    def threads_left(self) -> int:
        """How many threads that began since ``mark`` still do something, after a grace period."""
        deadline = time.monotonic() + _GRACE_SECONDS
        while left := [task for task in self._tasks() - self._known if self._is_busy(task)]:
            if time.monotonic() > deadline:
                return len(left)
            time.sleep(_LOOK_SECONDS)
        return 0

    def close(self) -> None:
        """Forgets the process."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    def _signal(self, number: int) -> None:
        if self._descriptor >= 0:
            with suppress(
                OSError
            ):  # by descriptor: the number of a process that has ended may be another's now
                signal.pidfd_send_signal(self._descriptor, number)

    def _tasks(self) -> frozenset[str]:
        try:
            return frozenset(os.listdir(f"/proc/{self.pid}/task") if self.pid else ())  # noqa: PTH208 - names
        except OSError:
            return frozenset()

    def _is_busy(self, task: str) -> bool:
        folder = Path(f"/proc/{self.pid}/task/{task}")
        try:
            state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
            if state in "XZ":
                return False
            if state != "S":
                return True
            with suppress(PermissionError):
                return (folder / "syscall").read_text().split()[0] not in _FUTEX_NUMBERS
            return (folder / "wchan").read_text() not in _IDLE | {"", "0"}
        except (OSError, IndexError):
            return False
