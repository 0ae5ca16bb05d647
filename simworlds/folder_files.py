"""The regular files beneath a folder that somebody else filled.

Nothing beneath the folder is reached through a link, and nothing but a regular file is read: each folder and each file
is opened from the folder that holds it, without following links and without waiting, and looked at once it is open. The
folder itself is what its user named, and may be reached through a link.
"""

from __future__ import annotations

import os
import stat
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from simworlds.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    Wanted = Callable[[PurePosixPath], bool]

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC
_CHUNK = 1 << 20


class FolderTooLarge(UserError):  # noqa: N818 - reads as the state it names
    """A folder holds more than its limits allow; the message says what."""


@dataclass(frozen=True, slots=True)
class FolderLimits:
    """How much of a folder is read.

    A file of more than ``file_bytes`` and a folder more than ``depth`` levels down are passed over. More than ``files``
    wanted files, ``entries`` names of any kind or ``total_bytes`` in all condemn the folder.
    """

    files: int = 50_000
    entries: int = 1_000_000
    depth: int = 30
    file_bytes: int = 16 << 20
    total_bytes: int = 3 << 30


@dataclass(frozen=True, slots=True)
class FolderFile:
    """A regular file: its path relative to the folder, and what tells whether it has changed (bytes, ns, inode)."""

    name: str
    size: int
    changed: int
    inode: int


@dataclass(slots=True)
class FolderFiles:
    """The wanted files beneath a folder, sorted by name, and how many entries were passed over."""

    folder: Path
    files: list[FolderFile] = field(default_factory=list)
    links: int = 0
    misnamed: int = 0
    special: int = 0
    too_large: int = 0
    too_deep: int = 0

    def beneath(self, folder: PurePosixPath) -> FolderFiles:
        """Those in a folder beneath this one; what was passed over is not counted again."""
        if folder == PurePosixPath():
            return self
        start = f"{folder}/"
        files = [
            FolderFile(file.name.removeprefix(start), file.size, file.changed, file.inode)
            for file in self.files
            if file.name.startswith(start)
        ]
        return FolderFiles(self.folder / folder, files)

    def passed_over(self) -> str:
        """What was passed over, as ``"3 links, 1 file over the limit"``; empty when nothing was."""
        counts = (
            (self.links, "link", "links"),
            (self.misnamed, "name that is not UTF-8", "names that are not UTF-8"),
            (
                self.special,
                "entry that is neither file nor folder",
                "entries that are neither file nor folder",
            ),
            (self.too_large, "file that is too large", "files that are too large"),
            (self.too_deep, "folder that lies too deep", "folders that lie too deep"),
        )
        return ", ".join(f"{count:,} {one if count == 1 else many}" for count, one, many in counts if count)


def list_files(folder: Path, wanted: Wanted, limits: FolderLimits | None = None) -> FolderFiles:
    """The regular files beneath ``folder`` whose relative path is ``wanted``. Hidden names are passed over silently.

    Raises OSError when the folder cannot be read, and FolderTooLarge.
    """
    walk = _Walk(FolderFiles(folder), wanted, limits or FolderLimits())
    top = os.open(folder, _FOLDER)
    try:
        walk.visit(top, PurePosixPath(), 0)
    finally:
        os.close(top)
    walk.found.files.sort(key=lambda file: file.name)
    return walk.found


def _is_text(name: str) -> bool:
    """Whether a name can be written as text: other bytes than UTF-8 stand in it as lone surrogates."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True


@dataclass(slots=True)
class _Walk:
    found: FolderFiles
    wanted: Wanted
    limits: FolderLimits
    entries: int = 0
    total: int = 0

    def visit(self, folder: int, path: PurePosixPath, depth: int) -> None:
        """Looks at the entries of an open folder."""
        with os.scandir(folder) as entries:
            for entry in entries:
                self.entries += 1
                if self.entries > self.limits.entries:
                    raise self._too_large(f"{self.limits.entries:,} entries")
                if entry.name.startswith("."):
                    continue
                if not _is_text(entry.name):
                    self.found.misnamed += 1
                elif entry.is_symlink():
                    self.found.links += 1
                elif entry.is_dir(follow_symlinks=False):
                    self._enter(folder, path / entry.name, depth + 1)
                elif not entry.is_file(follow_symlinks=False):
                    self.found.special += 1
                elif self.wanted(file := path / entry.name):
                    self._add(file, entry.stat(follow_symlinks=False))

    def _enter(self, above: int, path: PurePosixPath, depth: int) -> None:
        if depth > self.limits.depth:
            self.found.too_deep += 1
            return
        folder = os.open(path.name, _FOLDER | os.O_NOFOLLOW, dir_fd=above)
        try:
            self.visit(folder, path, depth)
        finally:
            os.close(folder)

    def _add(self, path: PurePosixPath, status: os.stat_result) -> None:
        if status.st_size > self.limits.file_bytes:
            self.found.too_large += 1
            return
        self.total += status.st_size
        if self.total > self.limits.total_bytes:
            raise self._too_large(f"{self.limits.total_bytes >> 20:,} MiB")
        if len(self.found.files) >= self.limits.files:
            raise self._too_large(f"{self.limits.files:,} files of its kind")
        self.found.files.append(
            FolderFile(path.as_posix(), status.st_size, status.st_mtime_ns, status.st_ino)
        )

    def _too_large(self, what: str) -> FolderTooLarge:
        return FolderTooLarge(
            f"{self.found.folder} holds more than {what}; no documentation does. Give the folder with the pages"
        )


def read_file(folder: Path, name: str, *, most: int, cut: bool = False) -> bytes:
    """The content of the regular file ``name`` beneath ``folder``, at most ``most`` bytes.

    Raises OSError, also when the file is longer than that, unless it may be ``cut``.
    """
    with _open_folder(folder, PurePosixPath(name)) as (above, last):
        number = os.open(last, _FILE, dir_fd=above)
    with os.fdopen(number, "rb", buffering=0) as file:
        status = os.fstat(number)
        if not stat.S_ISREG(status.st_mode):
            raise OSError(f"{folder / name} is not a regular file")
        step = min(status.st_size + 1, _CHUNK)
        parts: list[bytes] = []
        left = most + (not cut)
        while left > 0 and (part := file.read(min(left, step))):
            parts.append(part)
            left -= len(part)
    if left <= 0 and not cut:
        raise OSError(f"{folder / name} holds more than {most:,} bytes")
    return b"".join(parts)


@contextmanager
def _open_folder(folder: Path, path: PurePosixPath) -> Generator[tuple[int, str]]:
    """(the open folder that holds ``path``, its name there)."""
    if path.is_absolute() or ".." in path.parts or not path.parts:
        raise OSError(f"{path} does not lie beneath {folder}")
    here = os.open(folder, _FOLDER)
    try:
        for part in path.parts[:-1]:
            inner = os.open(part, _FOLDER | os.O_NOFOLLOW, dir_fd=here)
            os.close(here)
            here = inner
        yield here, path.parts[-1]
    finally:
        os.close(here)
