"""Folders that a sandboxed process writes to, and all that is done in them from outside.

What lies there may be anything, and may change at any moment: links, pipes, sparse files, folders without end. So
nothing in such a folder is ever opened by its path. Each access walks down open descriptors from the folder itself,
whose parent the process cannot reach; follows no link; and takes regular files only, judged by the open descriptor and
limited in size. What is handed over to the process appears whole, by a rename.
"""

from __future__ import annotations

import ctypes
import errno
import os
import secrets
import shutil
import stat
import struct
import tempfile
import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

from simworlds.sandbox.errors import NotThere, Refusal

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

DEEPEST = 64  # folders in folders
LARGEST_FILE = 4 << 30
"""Bytes of a file that is taken, unless a caller allows fewer."""
_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
_PLACE = getattr(os, "O_PATH", os.O_RDONLY) | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_BLOCK = 4096
_CHUNK = 1 << 20
_OPENAT2 = 437  # on every machine
_RESOLVE = 0x02 | 0x04 | 0x08  # no links of /proc, no symbolic links, nothing above
_libc = ctypes.CDLL(None, use_errno=True)


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


@dataclass(frozen=True, slots=True)
class HostileGround:
    """A folder that a sandboxed process writes to. Paths in it are relative, as ``"caches/0001.vdb"``.

    ``mount`` is its whole path, to start the process with. From outside, nothing below it is opened by that.
    """

    mount: Path

    def make(self) -> HostileGround:
        """Makes the folder unless it is there; returns it by its real path. Raises OSError."""
        self.mount.mkdir(parents=True, exist_ok=True)
        return HostileGround(self.mount.resolve())

    def beside(self, name: str) -> HostileGround:
        """A folder of that name beside it."""
        return HostileGround(self.mount.with_name(name))

    def holds(self, path: Path) -> bool:
        """Whether a path leads below it, as it is spelled."""
        return path.is_relative_to(self.mount)

    def for_blender(self, relative: str = "") -> str:
        """A path below it (or its own) as the process itself opens it."""
        return str(self.mount / relative)

    def from_blender(self, path: str) -> str | None:
        """A path as the process itself opens it, from here; None for one that is not below it."""
        pure = PurePosixPath(path)
        if not pure.is_relative_to(self.mount) or ".." in pure.parts:
            return None
        return str(pure.relative_to(self.mount))

    # What the process has made

    def files_below(self, relative: str) -> list[str]:
        """The regular files below a folder, as paths from that folder; no link is followed. Raises Refusal."""
        with _opened_folder(self.mount) as ground:
            try:
                folder = _open_beneath(ground, PurePosixPath(relative).parts)
            except OSError as error:
                raise _cannot_open(relative, error) from error
            try:
                return list(_regular_files(folder))
            finally:
                os.close(folder)

    def open(self, relative: str, *, at_most: int = LARGEST_FILE) -> BinaryIO:
        """Opens a regular file of at most so many bytes, for reading. Raises Refusal."""
        with self._within(relative) as (folder, name):
            return _open_regular(folder, name, relative, at_most)

    def read(self, relative: str, *, at_most: int) -> bytes:
        """The bytes of a regular file. Raises Refusal."""
        with self.open(relative, at_most=at_most) as file:
            return file.read(at_most)

    def take(self, relative: str, target: Path, *, at_most: int = LARGEST_FILE, durable: bool = True) -> int:
        """Moves a file to ``target``, whole or not at all; returns its bytes. ``durable`` waits for the disk.

        It is copied, since the process may still have it open. Raises Refusal.
        """
        with self._within(relative) as (folder, name):
            with _open_regular(folder, name, relative, at_most) as source:
                size = copy_to(source, target, durable=durable)
            with suppress(OSError):
                os.unlink(name, dir_fd=folder)
            return size

    # What is handed to the process

    def put(self, source: Path, name: str) -> None:
        """Copies a file of ours to it as ``name``, replacing whatever is there. Raises Refusal."""
        with _opened_folder(self.mount) as ground, _scratch(self.mount) as scratch:
            try:
                with source.open("rb") as file:
                    _copy_new(file, scratch, name, durable=False)
                _give_to_owner(scratch, name, ground)
                self._clear(ground, name)
                os.replace(name, name, src_dir_fd=scratch, dst_dir_fd=ground)
            except OSError as error:
                raise _cannot_write(f"{self.mount.name}/{name}", error) from error

    def put_folder(self, source: Path, name: str) -> None:
        """Copies a folder of ours to it as ``name``, replacing whatever is there; it stays ours. Raises Refusal."""
        try:
            with (
                tempfile.TemporaryDirectory(prefix=".handover-", dir=self.mount.parent) as scratch,
                _opened_folder(self.mount) as ground,
            ):
                copy = shutil.copytree(source, Path(scratch, name), copy_function=shutil.copyfile)
                self._clear(ground, name)
                os.rename(copy, name, dst_dir_fd=ground)
        except OSError as error:  # as are the errors of copytree
            raise _cannot_write(f"{self.mount.name}/{name}", error) from error

    def write(self, relative: str, content: bytes, *, over: bytes) -> None:
        """Writes a file that only its owner reads, whole or not at all. Raises Refusal.

        An existing file is replaced only if it is a regular one of ours that is empty or begins with ``over``.
        """
        with self._within(relative) as (folder, name):
            part = f".{secrets.token_hex(8)}.part"
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
            try:
                _check_replaceable(folder, name, over)
                with os.fdopen(os.open(part, flags, 0o600, dir_fd=folder), "wb") as file:
                    file.write(content)
                os.replace(part, name, src_dir_fd=folder, dst_dir_fd=folder)
            except OSError as error:
                raise _cannot_write(relative, error) from error
            finally:
                with suppress(OSError):
                    os.unlink(part, dir_fd=folder)

    # Removing

    def remove(self, relative: str) -> None:
        """Removes a file, a link or a folder, however deep. What is not there or cannot be removed is no error."""
        with suppress(OSError, Refusal), self._within(relative) as (folder, name):
            self._clear(folder, name)

    def _clear(self, folder: int, name: str) -> None:
        with suppress(FileNotFoundError):
            if stat.S_ISDIR(os.stat(name, dir_fd=folder, follow_symlinks=False).st_mode):
                _empty(os.open(name, _FOLDER, dir_fd=_reachable(folder, name)))
                os.rmdir(name, dir_fd=folder)
            else:
                os.unlink(name, dir_fd=folder)

    def empty(self) -> None:
        """Removes everything in it, however deep; the folder itself stays."""
        with suppress(OSError):
            _empty(os.open(self.mount, _FOLDER))

    def remove_since(self, moment: int) -> None:
        """Removes files created or changed since ``moment`` (see ``now``), and folders that become empty.

        Folders at DEEPEST are removed whole.
        """
        for entry in self.walk():
            with suppress(OSError):
                if entry.is_folder and entry.depth >= DEEPEST:
                    _empty(os.open(entry.name, _FOLDER, dir_fd=entry.parent))
                if entry.status.st_ctime_ns < moment:
                    continue
                if entry.is_folder:
                    os.rmdir(entry.name, dir_fd=entry.parent)
                else:
                    os.unlink(entry.name, dir_fd=entry.parent)

    def remove_named(self, ending: str) -> None:
        """Removes everything but folders whose name ends with ``ending``."""
        for entry in self.walk():
            if entry.name.endswith(ending) and not entry.is_folder:
                with suppress(OSError):
                    os.unlink(entry.name, dir_fd=entry.parent)

    # Measuring

    def walk(self) -> Iterator[WalkedEntry]:
        """Everything in it, contents before their folder; what vanishes meanwhile is left out.

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
                enter(os.open(self.mount, _FOLDER), None)
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
                        enter(os.open(entry.name, _FOLDER, dir_fd=number), entry)
                        continue
                except OSError:
                    continue
                yield entry
        finally:
            while stack:
                leave()

    def measure(self, at_most: int = 0) -> DiskUsage:
        """The disk usage, down to DEEPEST; counting ends at ``at_most`` files (0: never)."""
        size = files = deepest = 0
        for entry in self.walk():
            size += max(entry.status.st_blocks * 512, _BLOCK)
            files += 1
            deepest = max(deepest, entry.depth)
            if 0 < at_most < files:
                break
        return DiskUsage(size, files, deepest)

    def now(self) -> int:
        """A time later than all changes to files so far, in nanoseconds of the clock of its file system.

        That clock may stand still for milliseconds, so changes right after may seem to come before.
        """
        try:
            # Beside the ground, so on its file system, and out of the process's reach.
            with tempfile.TemporaryFile(dir=self.mount.parent, buffering=0) as file:
                first = os.fstat(file.fileno()).st_ctime_ns
                file.write(b"x")  # newer kernels do not give the same time twice once it was read
                second = os.fstat(file.fileno()).st_ctime_ns
        except OSError:
            return time.time_ns()
        return second if second > first else first + 1

    @contextmanager
    def _within(self, relative: str) -> Generator[tuple[int, str]]:
        """(open folder, name in it) of a relative path, reached through folders only. Raises Refusal."""
        parts = PurePosixPath(relative).parts
        if not parts or ".." in parts or relative.startswith("/") or "\0" in relative:
            raise Refusal(f"{relative[:200]!r} is not a valid path in the workspace.")
        with _opened_folder(self.mount) as ground:
            try:
                folder = _open_beneath(ground, parts[:-1])
            except OSError as error:
                raise _cannot_open(relative, error) from error
            try:
                yield folder, parts[-1]
            finally:
                os.close(folder)


def copy_to(source: BinaryIO, target: Path, *, durable: bool = True) -> int:
    """Copies an open file to ``target``, whole or not at all; returns its bytes. Raises Refusal."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with _opened_folder(target.parent) as folder:
            part = f".{secrets.token_hex(8)}.part"
            try:
                size = _copy_new(source, folder, part, durable=durable)
                os.replace(part, target.name, src_dir_fd=folder, dst_dir_fd=folder)
            finally:
                with suppress(OSError):
                    os.unlink(part, dir_fd=folder)
            return size
    except OSError as error:
        raise _cannot_write(target.name, error) from error


def _copy_new(source: BinaryIO, folder: int, name: str, *, durable: bool) -> int:
    """Copies to a new file, up to the size that the source has now; returns its bytes. Raises OSError."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    size, done = os.fstat(source.fileno()).st_size, 0
    with os.fdopen(os.open(name, flags, 0o644, dir_fd=folder), "wb") as copy:
        with suppress(OSError, AttributeError):  # within the kernel, where it can
            while done < size:
                sent = os.copy_file_range(source.fileno(), copy.fileno(), size - done, done, done)
                if sent == 0:
                    break
                done += sent
        source.seek(done)
        copy.seek(done)
        while done < size and (data := source.read(min(_CHUNK, size - done))):
            copy.write(data)
            done += len(data)
        if durable:
            copy.flush()
            os.fsync(copy.fileno())
    return done


def _give_to_owner(folder: int, name: str, ground: int) -> None:
    """Gives a new file to the user who owns the ground: as root, the process runs as another. Raises OSError."""
    owner, own = os.fstat(ground), os.stat(name, dir_fd=folder, follow_symlinks=False)
    if (owner.st_uid, owner.st_gid) != (own.st_uid, own.st_gid):
        os.chown(name, owner.st_uid, owner.st_gid, dir_fd=folder, follow_symlinks=False)


@contextmanager
def _opened_folder(path: Path) -> Generator[int]:
    """A folder of ours, or the ground itself, open."""
    folder = os.open(path, _FOLDER)
    try:
        yield folder
    finally:
        os.close(folder)


@contextmanager
def _scratch(mount: Path) -> Generator[int]:
    """A folder beside the ground, on its file system and out of the process's reach, open; gone afterwards."""
    with (
        tempfile.TemporaryDirectory(prefix=".handover-", dir=mount.parent) as folder,
        _opened_folder(Path(folder)) as opened,
    ):
        yield opened


def _open_beneath(ground: int, parts: tuple[str, ...]) -> int:
    """A new descriptor of a folder below ``ground``, no link followed. Raises OSError."""
    if not parts:
        return os.dup(ground)
    how = struct.pack("QQQ", _FOLDER, 0, _RESOLVE)
    found = _libc.syscall(_OPENAT2, ground, os.fsencode("/".join(parts)), how, ctypes.c_size_t(len(how)))
    if found >= 0:
        return found
    fault = ctypes.get_errno()
    if fault not in {errno.ENOSYS, errno.EPERM, errno.E2BIG, errno.EINVAL}:
        raise OSError(fault, os.strerror(fault))
    folder = os.dup(ground)  # an older kernel: step by step
    for part in parts:
        try:
            inner = os.open(part, _FOLDER, dir_fd=folder)
        finally:
            os.close(folder)
        folder = inner
    return folder


def _open_regular(folder: int, name: str, relative: str, at_most: int) -> BinaryIO:
    try:
        number = os.open(name, _FILE, dir_fd=folder)
    except OSError as error:
        raise _cannot_open(relative, error) from error
    status = os.fstat(number)
    if not stat.S_ISREG(status.st_mode):
        os.close(number)
        raise Refusal(f"{relative[:200]} is not a regular file.")
    if status.st_size > at_most:
        os.close(number)
        raise Refusal(f"{relative[:200]} has {status.st_size:,} bytes; at most {at_most:,} are taken.")
    return os.fdopen(number, "rb")


def _check_replaceable(folder: int, name: str, start: bytes) -> None:
    """Raises Refusal unless ``name`` is free, or a file of ours that is empty or begins with ``start``."""
    try:
        with _open_regular(folder, name, name, LARGEST_FILE) as file:
            is_ours = os.fstat(file.fileno()).st_uid == os.geteuid()
            is_such = file.read(len(start)) in (b"", start)
    except NotThere:
        return
    if not (is_ours and is_such):
        raise Refusal(f"{name[:200]} is a file of another kind or owner, which is not replaced.")


def _cannot_open(relative: str, error: OSError) -> Refusal:
    kind = NotThere if error.errno == errno.ENOENT else Refusal
    return kind(f"{relative[:200]} was not written, or is not a regular file: {error.strerror}.")


def _cannot_write(name: str, error: OSError) -> Refusal:
    return Refusal(f"{name} cannot be written: {error.strerror or error}.")


def _reachable(folder: int, name: str) -> int:
    """Makes a folder readable whose mode was taken away; returns ``folder``. A link is left as it is."""
    with suppress(OSError):
        place = os.open(name, _PLACE, dir_fd=folder)
        try:
            # By the open descriptor: a name could have become a link meanwhile, which chmod would follow.
            Path(f"/proc/self/fd/{place}").chmod(0o700)
        finally:
            os.close(place)
    return folder


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
    inner = os.open(name, _FOLDER, dir_fd=_reachable(top, name))
    try:
        with os.scandir(inner) as entries:
            for entry in list(entries):
                with suppress(OSError):
                    if entry.is_dir(follow_symlinks=False):
                        _reachable(inner, entry.name)
                        os.rename(
                            entry.name, f"swept-{secrets.token_hex(8)}", src_dir_fd=inner, dst_dir_fd=top
                        )
                    else:
                        os.unlink(entry.name, dir_fd=inner)
    finally:
        os.close(inner)
    os.rmdir(name, dir_fd=top)


def _regular_files(folder: int, depth: int = 1) -> Iterator[str]:
    with os.scandir(folder) as items:
        for item in items:
            if item.is_file(follow_symlinks=False):
                yield item.name
            elif item.is_dir(follow_symlinks=False) and depth < DEEPEST:
                with suppress(OSError):
                    below = os.open(item.name, _FOLDER, dir_fd=folder)
                    try:
                        yield from (f"{item.name}/{name}" for name in _regular_files(below, depth + 1))
                    finally:
                        os.close(below)


def copy_folder(source: Path, target: Path) -> None:
    """Copies the regular files below a folder, links left out, to a new folder of ours. Raises Refusal."""
    ground = HostileGround(source)
    try:
        target.mkdir()
        names = list(_files_below(source))
    except OSError as error:
        raise _cannot_write(target.name, error) from error
    for name in names:
        with ground.open(name) as file:
            copy_to(file, target / name, durable=False)


def _files_below(folder: Path) -> Iterator[str]:
    for place, folders, names, opened in os.fwalk(folder, follow_symlinks=False):
        below = PurePosixPath(place).relative_to(folder)
        if len(below.parts) >= DEEPEST:
            folders.clear()
        for name in names:
            if stat.S_ISREG(os.stat(name, dir_fd=opened, follow_symlinks=False).st_mode):
                yield (below / name).as_posix()
