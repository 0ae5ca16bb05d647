"""Processes that end with the one that started them.

``python -I -S end_with_parent.py PARENT COMMAND …`` becomes such a process.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
from pathlib import Path

# Run as a script, it finds nothing of ours beside it. Windows has no SIGKILL.
KILL: signal.Signals = getattr(signal, "SIGKILL", signal.SIGTERM)

_SET_PDEATHSIG = 1  # of <linux/prctl.h>


def end_with_parent(parent: int, number: signal.Signals = KILL) -> None:
    """Has the system send this process a signal when the thread that started it ends; where it offers that (Linux).

    ``parent``: the process that started it, which may have ended meanwhile.
    """
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_SET_PDEATHSIG, number)
    if os.getppid() != parent:
        os.kill(os.getpid(), number)


def ending_with_this(words: list[str]) -> list[str]:
    """A command that is killed when the thread that starts it ends."""
    return [sys.executable, "-I", "-S", str(Path(__file__).resolve()), str(os.getpid()), *words]


if __name__ == "__main__":
    end_with_parent(int(sys.argv[1]))
    os.execv(sys.argv[2], sys.argv[2:])  # noqa: S606 - the point of it
