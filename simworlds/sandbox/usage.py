"""What a Blender uses of disk, memory and threads, measured from outside, and the removal of what it left behind.

Code that runs in Blender may write to these folders meanwhile, with bad intent. So they are walked by descriptor, links
are not followed, and no depth or number of folders can keep the walk from ending.
"""

from __future__ import annotations

import os
import stat
import tempfile
import time
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from simworlds.sandbox.nameless_files import nameless_files
from simworlds.sandbox.watched_process import WatchedProcess

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simworlds.sandbox.confined_command import ResourceLimits

DEEPEST = 64  # folders in folders
_LEAST_FREE = (
    1 << 30
)  # bytes that stay free on the disk for others; half of what is free at the start, if less
_OPEN_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_BLOCK = 4096
_MOST_COUNTED = 2_000_000
_CHECK_SECONDS = 0.25  # between two counts of the files
_PAUSE = 10.0  # after a slow count, in its durations
_MUCH_SPACE, _MANY_FILES = 150_000_000, 10_000  # taken since the last count, for the next to come at once
_QUICK_SECONDS = 0.02
_numbers = count()


class DiskUsage(NamedTuple):
    """Bytes on disk, the number of files and folders, and the depth of the deepest one, up to DEEPEST."""

    bytes: int
    files: int
    deepest: int = 0


class WalkedEntry(NamedTuple):
    """A file, link or folder: ``name`` in the open folder ``parent``, ``depth`` folders below the first."""

    parent: int
    name: str
    depth: int
    status: os.stat_result

    @property
    def is_folder(self) -> bool:
        """Whether it is a folder, not a link to one."""
        return stat.S_ISDIR(self.status.st_mode)


def walk(folder: Path) -> Iterator[WalkedEntry]:
    """Everything below ``folder``, contents before their folder; what vanishes meanwhile is left out.

    Folders at DEEPEST are not entered.
    """
    stack: list[tuple[int, Any, WalkedEntry | None]] = []

    def enter(number: int, entry: WalkedEntry | None) -> None:
        stack.append((number, os.scandir(number), entry))

    def leave() -> WalkedEntry | None:
        number, entries, entry = stack.pop()
        entries.close()
        os.close(number)
        return entry

    try:
        with suppress(OSError):
            enter(os.open(folder, _OPEN_FOLDER), None)
        while stack:
            number, entries, _ = stack[-1]
            item = next(entries, None)
            if item is None:
                if (own := leave()) is not None:
                    yield own
                continue
            try:
                entry = WalkedEntry(number, item.name, len(stack), item.stat(follow_symlinks=False))
                if entry.is_folder and entry.depth < DEEPEST:
                    enter(os.open(entry.name, _OPEN_FOLDER, dir_fd=number), entry)
                    continue
            except OSError:
                continue
            yield entry
    finally:
        while stack:
            leave()


def measure(folder: Path, at_most: int = 0) -> DiskUsage:
    """The disk usage below ``folder``, down to DEEPEST; counting ends at ``at_most`` files."""
    size = files = deepest = 0
    for entry in walk(folder):
        size += max(entry.status.st_blocks * 512, _BLOCK)
        files += 1
        deepest = max(deepest, entry.depth)
        if 0 < at_most < files:
            break
    return DiskUsage(size, files, deepest)


def empty_folder(folder: Path) -> None:
    """Removes everything below ``folder``, however deep; the folder itself stays."""
    with suppress(OSError):
        _empty(os.open(folder, _OPEN_FOLDER))


def _empty(top: int) -> None:
    """Removes everything in an open folder, and closes it.

    Deeper folders are first moved up, so that this needs neither long paths nor many descriptors.
    """
    before: list[str] = []
    try:
        # Ends when nothing is left, or nothing more can be removed.
        while (names := sorted(os.listdir(top))) and names != before:
            before = names
            for name in names:
                with suppress(OSError):
                    _flatten(top, name)
    finally:
        os.close(top)


def _flatten(top: int, name: str) -> None:
    """Removes an entry. A folder's own folders are moved to ``top``, everything else in it is removed."""
    if not stat.S_ISDIR(os.stat(name, dir_fd=top, follow_symlinks=False).st_mode):
        os.unlink(name, dir_fd=top)
        return
    os.chmod(name, 0o700, dir_fd=top)
    inner = os.open(name, _OPEN_FOLDER, dir_fd=top)
    try:
        with os.scandir(inner) as entries:
            for entry in list(entries):
                with suppress(OSError):
                    if entry.is_dir(follow_symlinks=False):
                        os.chmod(entry.name, 0o700, dir_fd=inner)
                        os.rename(entry.name, _unused_name(), src_dir_fd=inner, dst_dir_fd=top)
                    else:
                        os.unlink(entry.name, dir_fd=inner)
    finally:
        os.close(inner)
    os.rmdir(name, dir_fd=top)


def _unused_name() -> str:
    return f"swept-{os.getpid()}-{time.monotonic_ns()}-{next(_numbers)}"


def remove(path: Path) -> None:
    """Removes a file, a link or a folder, however deep. What is not there or cannot be removed is no error."""
    with suppress(OSError):
        if stat.S_ISDIR(path.lstat().st_mode):
            empty_folder(path)
            path.rmdir()
        else:
            path.unlink()


def remove_since(folder: Path, moment: int) -> None:
    """Removes files below ``folder`` created or changed since ``moment`` (see now), and folders that become empty.

    Folders at DEEPEST are removed whole.
    """
    for entry in walk(folder):
        with suppress(OSError):
            if entry.is_folder and entry.depth >= DEEPEST:
                _empty(os.open(entry.name, _OPEN_FOLDER, dir_fd=entry.parent))
            if entry.status.st_ctime_ns < moment:
                continue
            if entry.is_folder:
                os.rmdir(entry.name, dir_fd=entry.parent)
            else:
                os.unlink(entry.name, dir_fd=entry.parent)


def remove_named(folder: Path, ending: str) -> None:
    """Removes the files below ``folder`` whose names end with ``ending``."""
    for entry in walk(folder):
        if entry.name.endswith(ending) and stat.S_ISREG(entry.status.st_mode):
            with suppress(OSError):
                os.unlink(entry.name, dir_fd=entry.parent)


def now(folder: Path) -> int:
    """A time later than all changes to files so far, in nanoseconds of the clock of ``folder``'s file system.

    That clock may stand still for milliseconds, so changes right after may seem to come before.
    """
    try:
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
            first = os.fstat(file.fileno()).st_ctime_ns
            file.write(b"x")  # newer kernels do not give the same time twice once it was read
            second = os.fstat(file.fileno()).st_ctime_ns
    except OSError:
        return time.time_ns()
    return second if second > first else first + 1


class UsageMonitor:
    """Checks whether a process is over its limits, each time that it is asked. It may write to ``folders``.

    What lies there at the start does not count as excess. ``last_within_limits`` is the last time (see now) at which
    no limit was exceeded.

    Each check looks at the process and at the free space of the file systems: that takes a fraction of a millisecond,
    however many files there are. The files are counted now and then, and at once when more space was taken than may
    still be. While they are counted, the process stands still, so nothing is written unseen.
    """

    def __init__(self, folders: tuple[Path, ...], limits: ResourceLimits) -> None:
        self._folders = folders
        self._limits = limits
        self._process = WatchedProcess(0)
        self._next = self._next_at_end = 0.0
        self._at_start = self._at_walk = self._free()
        self._devices = frozenset(self._at_start)
        self._least_free = {
            device: min(_LEAST_FREE, free.bytes // 2) for device, free in self._at_start.items()
        }
        present = self._walked = self._disk_usage(_MOST_COUNTED)
        self._present = present
        self._most = DiskUsage(max(limits.disk, present.bytes), max(limits.files, present.files))
        self.last_within_limits = now(folders[-1])

    def watch(self, process: int) -> None:
        """Also checks this process (by its number outside the sandbox) from here on."""
        self._process = WatchedProcess(process)

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
        with self._process.standing_still():
            moment = now(self._folders[-1])
            excess = self._excess_on_disk()
        if excess is None:
            self.last_within_limits = moment
        ended = time.monotonic()
        self._next_at_end = ended + (_PAUSE * (ended - started) if ended - started > _QUICK_SECONDS else 0.0)
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
        usages = [measure(folder, at_most) for folder in self._folders]
        size, files = sum(usage.bytes for usage in usages), sum(usage.files for usage in usages)
        nameless = nameless_files(self._process.number, self._devices)
        size += nameless.bytes
        if nameless.mapped:
            # Their size is unknown, but at most what nothing else explains.
            unexplained = _taken(self._at_start, self._free()).bytes - (size - self._present.bytes)
            size += max(0, min(unexplained, nameless.mapped * (self._limits.file_size or unexplained)))
        return DiskUsage(size, files + nameless.open, max(usage.deepest for usage in usages))

    def _free(self) -> dict[int, FreeSpace]:
        """File system → what is free on it, of those that the folders are on."""
        free: dict[int, FreeSpace] = {}
        for folder in self._folders:
            with suppress(OSError):
                disk = os.statvfs(folder)
                device = folder.lstat().st_dev
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
