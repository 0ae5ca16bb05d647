"""What a Blender uses of disk, memory and threads, measured from outside."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from simworlds.sandbox.hostile_ground import DEEPEST, DiskUsage, HostileGround
from simworlds.sandbox.watch.nameless_files import nameless_files
from simworlds.sandbox.watch.watched_process import WatchedProcess

if TYPE_CHECKING:
    from simworlds.sandbox.confinement.resource_limits import ResourceLimits

_LEAST_FREE = (
    1 << 30
)  # bytes that stay free on the disk for others; half of what is free at the start, if less
_MOST_COUNTED = 2_000_000
_CHECK_SECONDS = 0.25  # between two counts of the files
_PAUSE = 10.0  # after a slow count, in its durations
_QUICK_SECONDS = 0.02  # of work; waiting for a core makes no count a slow one
_MUCH_SPACE, _MANY_FILES = 150_000_000, 10_000  # taken since the last count, for the next to come at once
_LITTLE_SPACE = 5_000_000  # of which it does not matter who took it


class UsageMonitor:
    """Checks whether a process is over its limits, each time that it is asked. It may write to ``folders``.

    What lies there at the start does not count as excess. ``last_within_limits`` is the last time at which no limit was
    exceeded, as HostileGround.now tells it.

    Each check looks at the process and at the free space of the file systems: that takes a fraction of a millisecond,
    however many files there are. The files are counted now and then, and at once when more space was taken than may
    still be. While they are counted, the process stands still, so nothing is written unseen.
    """

    def __init__(self, folders: tuple[HostileGround, ...], limits: ResourceLimits) -> None:
        self._folders = folders
        self._limits = limits
        self._process = WatchedProcess(0)
        self._next = self._next_at_end = 0.0
        self._at_start = self._at_walk = self._free()
        self._devices = frozenset(self._at_start)
        self._taken_at_look = self._mapped = 0
        self._least_free = {
            device: min(_LEAST_FREE, free.bytes // 2) for device, free in self._at_start.items()
        }
        present = self._walked = self._disk_usage(_MOST_COUNTED)
        self._present = present
        self._most = DiskUsage(max(limits.disk, present.bytes), max(limits.files, present.files))
        self.last_within_limits = folders[-1].now()

    def watch(self, process: WatchedProcess) -> None:
        """Also checks this process from here on."""
        self._process = process
        self._taken_at_look = self._mapped = 0

    def excess(self, *, at_end: bool = False) -> str | None:
        """Which limit is exceeded, in words.

        ``at_end``: the call has ended, so the pause between two counts is skipped unless counting is slow.
        """
        started = time.monotonic()
        free = self._free()
        if (excess := self._excess_of_process() or self._excess_of_space(free)) is not None:
            return excess
        due = started >= (self._next_at_end if at_end else self._next)
        if not due and not self._may_exceed(free):
            return None
        worked = time.thread_time()
        with self._process.standing_still():
            moment = self._folders[-1].now()
            excess = self._excess_on_disk()
        if excess is None:
            self.last_within_limits = moment
        ended = time.monotonic()
        slow = time.thread_time() - worked > _QUICK_SECONDS
        self._next_at_end = ended + (_PAUSE * (ended - started) if slow else 0.0)
        self._next = max(ended + _CHECK_SECONDS, self._next_at_end)
        return excess

    def _excess_of_process(self) -> str | None:
        limits = self._limits
        memory, threads = self._process.memory_and_threads()
        if 0 < limits.threads < threads:
            return f"started {threads:,} threads; the limit is {limits.threads:,}"
        if 0 < limits.memory < memory:
            return f"used {_size(memory)} of memory; the limit is {_size(limits.memory)}"
        return None

    def _excess_of_space(self, free: dict[int, FreeSpace]) -> str | None:
        for device, space in free.items():
            least = self._least_free.get(device, 0)
            if space.bytes < least:
                return f"left {_size(space.bytes)} free on the disk; {_size(least)} must stay free"
        return None

    def _may_exceed(self, free: dict[int, FreeSpace]) -> bool:
        """Whether so much space was taken since the last count, by whomever, that a limit may be exceeded."""
        taken = _taken(self._at_walk, free)
        walked, most, limits = self._walked, self._most, self._limits
        much = taken.bytes >= _MUCH_SPACE and walked.bytes + taken.bytes > most.bytes and limits.disk > 0
        return much or (
            taken.files >= _MANY_FILES and walked.files + taken.files > most.files and limits.files > 0
        )

    def _excess_on_disk(self) -> str | None:
        limits = self._limits
        self._at_walk = self._free()
        usage = self._walked = self._disk_usage(self._most.files if limits.files else 0)
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
        taken = _taken(self._at_start, self._free()).bytes
        # What is mapped is looked for again when space was taken since: that takes longer than all else.
        looks = taken > self._taken_at_look + _LITTLE_SPACE
        nameless = nameless_files(self._process.number, self._devices, mapped=looks)
        if looks:
            self._taken_at_look, self._mapped = taken, nameless.mapped
        else:
            self._taken_at_look = min(self._taken_at_look, taken)
        size += nameless.bytes
        if self._mapped:
            # Their size is unknown, but at most what nothing else explains.
            unexplained = taken - (size - self._present.bytes)
            size += max(0, min(unexplained, self._mapped * (self._limits.file_size or unexplained)))
        return DiskUsage(size, files + nameless.open, max(usage.deepest for usage in usages))

    def _free(self) -> dict[int, FreeSpace]:
        """File system → what is free on it, of those that the folders are on."""
        free: dict[int, FreeSpace] = {}
        for folder in self._folders:
            with suppress(OSError):
                disk = os.statvfs(folder.mount)
                device = folder.mount.lstat().st_dev
                free[device] = FreeSpace(disk.f_bavail * disk.f_frsize, disk.f_ffree)
        return free


class FreeSpace(NamedTuple):
    """Free bytes of a file system, and how many more files it can hold."""

    bytes: int
    files: int


def _taken(before: dict[int, FreeSpace], after: dict[int, FreeSpace]) -> FreeSpace:
    """By how much free space became less."""
    both = [(before[device], space) for device, space in after.items() if device in before]
    return FreeSpace(
        sum(max(0, old.bytes - new.bytes) for old, new in both),
        sum(max(0, old.files - new.files) for old, new in both),
    )


def _size(amount: int) -> str:
    return f"{amount / 1e9:,.1f} GB" if amount >= 1e9 else f"{amount / 1e6:,.0f} MB"
