"""What a Blender uses of disk, memory and threads, measured from outside."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.hostile_ground import DEEPEST, DiskUsage, HostileGround

if TYPE_CHECKING:
    from simworlds.sandbox.confined_command import ResourceLimits

_LEAST_FREE = (
    1 << 30
)  # bytes that stay free on the disk for others; half of what is free at the start, if less
_MOST_COUNTED = 2_000_000
_CHECK_SECONDS = 0.25  # between two checks
_PAUSE = 10.0  # after a slow check, in its durations
_QUICK_SECONDS = 0.005


class UsageMonitor:
    """Checks now and then whether a process is over its limits. It may write to ``folders``.

    What lies there at the start does not count as excess. ``last_within_limits`` is the last time at which no limit was
    exceeded, as HostileGround.now tells it.
    """

    def __init__(self, folders: tuple[HostileGround, ...], limits: ResourceLimits) -> None:
        self._folders = folders
        self._limits = limits
        self._process = 0
        self._next = self._next_at_end = 0.0
        self._least_free = min(_LEAST_FREE, _free(folders[0]) // 2)
        present = self._disk_usage(_MOST_COUNTED)
        self._most = DiskUsage(max(limits.disk, present.bytes), max(limits.files, present.files))
        self.last_within_limits = folders[-1].now()

    def watch(self, process: int) -> None:
        """Also checks this process (by its number outside the sandbox) from here on."""
        self._process = process

    def excess(self, *, at_end: bool = False) -> str | None:
        """Which limit is exceeded, in words; None also right after another check.

        ``at_end``: the call has ended, so the pause between two checks is skipped unless checks are slow.
        """
        started = time.monotonic()
        if started < (self._next_at_end if at_end else self._next):
            return None
        moment = self._folders[-1].now()
        excess = self._excess_of_process() or self._excess_on_disk()
        if excess is None:
            self.last_within_limits = moment
        ended = time.monotonic()
        self._next_at_end = ended + (_PAUSE * (ended - started) if ended - started > _QUICK_SECONDS else 0.0)
        self._next = max(ended + _CHECK_SECONDS, self._next_at_end)
        return excess

    def _excess_of_process(self) -> str | None:
        limits = self._limits
        memory, threads = _memory_and_threads(self._process)
        if 0 < limits.threads < threads:
            return f"started {threads:,} threads; the limit is {limits.threads:,}"
        if 0 < limits.memory < memory:
            return f"used {_size(memory)} of memory; the limit is {_size(limits.memory)}"
        return None

    def _excess_on_disk(self) -> str | None:
        limits = self._limits
        free = _free(self._folders[0])
        if free < self._least_free:
            return f"left {_size(free)} free on the disk; {_size(self._least_free)} must stay free"
        usage = self._disk_usage(self._most.files if limits.files else 0)
        if usage.deepest >= DEEPEST:
            return f"nested folders more than {DEEPEST} deep"
        if limits.disk and usage.bytes > self._most.bytes:
            return f"brought the run's files to {_size(usage.bytes)}; the limit is {_size(self._most.bytes)}"
        if limits.files and usage.files > self._most.files:
            return f"brought the run to more than {self._most.files:,} files"
        return None

    def _disk_usage(self, at_most: int) -> DiskUsage:
        usages = [folder.measure(at_most) for folder in self._folders]
        size, files = sum(usage.bytes for usage in usages), sum(usage.files for usage in usages)
        return DiskUsage(size, files, max(usage.deepest for usage in usages))


def _size(amount: int) -> str:
    return f"{amount / 1e9:,.1f} GB" if amount >= 1e9 else f"{amount / 1e6:,.0f} MB"


def _free(folder: HostileGround) -> int:
    try:
        disk = os.statvfs(folder.mount)
    except OSError:
        return 1 << 62
    return disk.f_bavail * disk.f_frsize


def _memory_and_threads(process: int) -> tuple[int, int]:
    """(bytes of memory not backed by a file, number of threads) of a process; 0 where that cannot be known."""
    if not process:
        return 0, 0
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
        values = dict(
            line.split(":\t", 1) for line in lines if line.startswith(("RssAnon", "RssShmem", "Threads"))
        )
        memory = sum(int(values[name].split()[0]) for name in ("RssAnon", "RssShmem"))
        return memory * 1024, int(values["Threads"])
    except (OSError, LookupError, ValueError):
        return 0, 0


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
