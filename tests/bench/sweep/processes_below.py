"""The processes that a process has started, and whether they end."""

from __future__ import annotations

import os
import select
import time
from contextlib import suppress
from pathlib import Path


def below(pid: int) -> set[int]:
    """A process's children, and theirs."""
    found: set[int] = set()
    waiting = [pid]
    while waiting:
        number = waiting.pop()
        with suppress(OSError):  # it has ended meanwhile
            own = {int(word) for word in Path(f"/proc/{number}/task/{number}/children").read_text().split()}
            found |= own
            waiting += own
    return found


def all_end(processes: set[int], seconds: float = 60) -> bool:
    """Whether all of them end, soon."""
    until = time.monotonic() + seconds
    return all(_ends(number, until - time.monotonic()) for number in processes)


def _ends(number: int, seconds: float) -> bool:
    try:
        descriptor = os.pidfd_open(number)
    except ProcessLookupError:
        return True
    try:
        return bool(select.select([descriptor], [], [], max(0.0, seconds))[0])
    finally:
        os.close(descriptor)
