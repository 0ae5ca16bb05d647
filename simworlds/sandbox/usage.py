"""How much a Blender has written and started, looked at from outside, and the clearing away of what it left.

Code that runs in Blender may be writing to these folders meanwhile, and may mean harm: they are walked by descriptor,
links are not followed, and neither depth nor number can keep the walk from ending.
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

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simworlds.sandbox.confinement import Limits

DEEPEST = 64  # folders in folders
_LEAST_FREE = 1 << 30  # bytes that are left to others on the disk, or half of what is free at the start
_OPEN_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_BLOCK = 4096
_MOST_COUNTED = 2_000_000
_LOOK_SECONDS = 0.25
_SPARING = 10.0  # between two looks that are not quick, so many times as long as one takes
_QUICK_SECONDS = 0.005
_numbers = count()


class Used(NamedTuple):
    """Bytes on disk, files and folders, and how deep the deepest of them lies, up to DEEPEST."""

    bytes: int
    files: int
    deepest: int = 0


class Entry(NamedTuple):
    """A file, link or folder: ``name`` in the open folder ``place``, ``depth`` folders below the first."""

    place: int
    name: str
    depth: int
    found: os.stat_result

    @property
    def is_folder(self) -> bool:
        """Whether it is one, and no link to one."""
        return stat.S_ISDIR(self.found.st_mode)


def walk(folder: Path) -> Iterator[Entry]:
    """All that lies below ``folder``, contents before their folder; what vanishes meanwhile is left out.

    Folders at DEEPEST are not looked into.
    """
    stack: list[tuple[int, Any, Entry | None]] = []

    def enter(number: int, entry: Entry | None) -> None:
        stack.append((number, os.scandir(number), entry))

    def leave() -> Entry | None:
        number, entries, entry = stack.pop()
        entries.close()
        os.close(number)
        return entry

    try:
        with suppress(OSError):
            enter(os.open(folder, _OPEN_FOLDER), None)
        while stack:
            number, entries, _ = stack[-1]
            found = next(entries, None)
            if found is None:
                if (own := leave()) is not None:
                    yield own
                continue
            try:
                entry = Entry(number, found.name, len(stack), found.stat(follow_symlinks=False))
                if entry.is_folder and entry.depth < DEEPEST:
                    enter(os.open(entry.name, _OPEN_FOLDER, dir_fd=number), entry)
                    continue
            except OSError:
                continue
            yield entry
    finally:
        while stack:
            leave()


def measure(folder: Path, at_most: int = 0) -> Used:
    """What lies below ``folder``, as far as DEEPEST; counting ends at ``at_most`` files."""
    size = files = deepest = 0
    for entry in walk(folder):
        size += max(entry.found.st_blocks * 512, _BLOCK)
        files += 1
        deepest = max(deepest, entry.depth)
        if 0 < at_most < files:
            break
    return Used(size, files, deepest)


def sweep(folder: Path) -> None:
    """Removes all that lies below ``folder``, however deep; the folder stays."""
    with suppress(OSError):
        _empty(os.open(folder, _OPEN_FOLDER))


def _empty(top: int) -> None:
    """Removes all in an open folder, and closes it.

    What is deeper than one level is first moved up, so that this needs neither long paths nor many descriptors.
    """
    seen: list[str] = []
    try:
        # Ends when nothing is left, or nothing of it can be removed.
        while (names := sorted(os.listdir(top))) and names != seen:
            seen = names
            for name in names:
                with suppress(OSError):
                    _flatten(top, name)
    finally:
        os.close(top)


def _flatten(top: int, name: str) -> None:
    """Removes an entry; of a folder, what is in it, but for its folders, which are moved to ``top``."""
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
                        os.rename(entry.name, _spare(), src_dir_fd=inner, dst_dir_fd=top)
                    else:
                        os.unlink(entry.name, dir_fd=inner)
    finally:
        os.close(inner)
    os.rmdir(name, dir_fd=top)


def _spare() -> str:
    """A name that nothing else has."""
    return f"swept-{os.getpid()}-{time.monotonic_ns()}-{next(_numbers)}"


def remove_since(folder: Path, moment: int) -> None:
    """Removes the files below ``folder`` made or changed since ``moment`` (see now), and folders that this empties.

    Folders at DEEPEST go whole.
    """
    for entry in walk(folder):
        with suppress(OSError):
            if entry.is_folder and entry.depth >= DEEPEST:
                _empty(os.open(entry.name, _OPEN_FOLDER, dir_fd=entry.place))
            if entry.found.st_ctime_ns < moment:
                continue
            if entry.is_folder:
                os.rmdir(entry.name, dir_fd=entry.place)
            else:
                os.unlink(entry.name, dir_fd=entry.place)


def remove_named(folder: Path, ending: str) -> None:
    """Removes the files below ``folder`` whose names end so."""
    for entry in walk(folder):
        if entry.name.endswith(ending) and stat.S_ISREG(entry.found.st_mode):
            with suppress(OSError):
                os.unlink(entry.name, dir_fd=entry.place)


def now(folder: Path) -> int:
    """A moment after all changes to files so far, in nanoseconds of the clock of ``folder``'s file system.

    That clock may stand still for milliseconds; changes that follow at once may then seem to come before.
    """
    try:
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
            first = os.fstat(file.fileno()).st_ctime_ns
            file.write(b"x")  # a time that was asked for is not given twice, where the kernel can help it
            second = os.fstat(file.fileno()).st_ctime_ns
    except OSError:
        return time.time_ns()
    return second if second > first else first + 1


class Bounds:
    """Looks now and then whether a process has gone past its limits. ``folders`` are those that it may write to."""

    def __init__(self, folders: tuple[Path, ...], limits: Limits) -> None:
        self._folders = folders
        self._limits = limits
        self._process = 0
        self._next = self._spared = 0.0
        self._least_free = min(_LEAST_FREE, _free(folders[0]) // 2)
        there = self._used(_MOST_COUNTED)
        self._most = Used(max(limits.disk, there.bytes), max(limits.files, there.files))
        self.fine = now(folders[-1])

    def watch(self, process: int) -> None:
        """From here on this process (in the supervisor's numbering) is looked at, too."""
        self._process = process

    def fault(self, *, over: bool = False) -> str | None:
        """In words, which limit was passed; None too when the last look was but just now.

        ``over``: the call is, and what it wrote is looked at unless that takes long. ``fine`` is the moment (see now)
        at which no limit was passed, the last time.
        """
        started = time.monotonic()
        if started < (self._spared if over else self._next):
            return None
        moment = now(self._folders[-1])
        found = self._fault_of_process() or self._fault_on_disk()
        if found is None:
            self.fine = moment
        ended = time.monotonic()
        self._spared = ended + (_SPARING * (ended - started) if ended - started > _QUICK_SECONDS else 0.0)
        self._next = max(ended + _LOOK_SECONDS, self._spared)
        return found

    def _fault_of_process(self) -> str | None:
        limits = self._limits
        memory, threads = _held(self._process)
        if 0 < limits.threads < threads:
            return f"started {threads:,} threads; {limits.threads:,} at most"
        if 0 < limits.memory < memory:
            return f"came to hold {_size(memory)} of memory; {_size(limits.memory)} at most"
        return None

    def _fault_on_disk(self) -> str | None:
        limits = self._limits
        free = _free(self._folders[0])
        if free < self._least_free:
            return f"left {_size(free)} free on the disk, where {_size(self._least_free)} are to stay free"
        used = self._used(self._most.files if limits.files else 0)
        if used.deepest >= DEEPEST:
            return f"put folders more than {DEEPEST} deep into each other"
        if limits.disk and used.bytes > self._most.bytes:
            return f"brought the run's files to {_size(used.bytes)}; {_size(self._most.bytes)} at most"
        if limits.files and used.files > self._most.files:
            return f"brought the run to more than {self._most.files:,} files"
        return None

    def _used(self, at_most: int) -> Used:
        each = [measure(folder, at_most) for folder in self._folders]
        size, files = sum(one.bytes for one in each), sum(one.files for one in each)
        return Used(size, files, max(one.deepest for one in each))


def _size(amount: int) -> str:
    return f"{amount / 1e9:,.1f} GB" if amount >= 1e9 else f"{amount / 1e6:,.0f} MB"


def _free(folder: Path) -> int:
    try:
        found = os.statvfs(folder)
    except OSError:
        return 1 << 62
    return found.f_bavail * found.f_frsize


def _held(process: int) -> tuple[int, int]:
    """(bytes of memory that no file holds, shared or not, threads) of a process; 0 where that cannot be known."""
    if not process:
        return 0, 0
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
        told = dict(
            line.split(":\t", 1) for line in lines if line.startswith(("RssAnon", "RssShmem", "Threads"))
        )
        memory = sum(int(told[name].split()[0]) for name in ("RssAnon", "RssShmem"))
        return memory * 1024, int(told["Threads"])
    except (OSError, LookupError, ValueError):
        return 0, 0


def innermost(process: int) -> int:
    """The last of the line of processes that begins with this one: Blender behind what it was started through."""
    for _ in range(8):
        try:
            children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
        except OSError:
            return process
        if not children:
            return process
        process = int(children[0])
    return process
