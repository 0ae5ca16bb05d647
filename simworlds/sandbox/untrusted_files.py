"""Opens and takes files below a folder that a sandboxed process writes to, without following links."""

from __future__ import annotations

import os
import shutil
import stat
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, BinaryIO

from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Generator


def take_beneath(root: Path, relative: str, target: Path, *, durable: bool = True) -> None:
    """Moves a file below ``root``, where executed code writes, to ``target``. ``durable`` waits for the disk.

    Raises Refusal.
    """
    with _beneath(root, relative) as (folder, name), _open_regular(folder, name, relative) as source:
        part = target.with_name(f".{target.name}.part")
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            with part.open("wb") as copy:
                copy_file(source, copy)
                if durable:
                    os.fsync(copy.fileno())
            part.replace(target)
        except OSError as error:
            part.unlink(missing_ok=True)
            raise Refusal(f"{target} cannot be written: {error.strerror or error}.") from error
        with suppress(OSError):
            os.unlink(name, dir_fd=folder)


def open_beneath(root: Path, relative: str) -> BinaryIO:
    """Opens a regular file below ``root`` folder by folder, so that no link leads out. Raises Refusal."""
    with _beneath(root, relative) as (folder, name):
        return _open_regular(folder, name, relative)


@contextmanager
def _beneath(root: Path, relative: str) -> Generator[tuple[int, str]]:
    """(open folder, name in it) of a path below ``root``, reached through folders only. Raises Refusal."""
    parts = PurePosixPath(relative).parts
    if not parts or ".." in parts or relative.startswith("/") or "\0" in relative:
        raise Refusal(f"{relative!r} is not a valid path in the workspace.")
    folder = os.open(root, os.O_RDONLY | os.O_DIRECTORY)
    try:
        for part in parts[:-1]:
            try:
                inner = os.open(part, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW, dir_fd=folder)
            except OSError as error:
                raise _cannot_open(relative, error) from error
            os.close(folder)
            folder = inner
        yield folder, parts[-1]
    finally:
        os.close(folder)


def _open_regular(folder: int, name: str, relative: str) -> BinaryIO:
    try:
        number = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
    except OSError as error:
        raise _cannot_open(relative, error) from error
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise Refusal(f"{relative} is not a regular file.")
    return os.fdopen(number, "rb")


def _cannot_open(relative: str, error: OSError) -> Refusal:
    return Refusal(f"{relative} was not written, or is not a regular file: {error.strerror}.")


def copy_file(source: BinaryIO, target: BinaryIO) -> None:
    """Copies all of a file, within the kernel where it can."""
    try:
        size = os.fstat(source.fileno()).st_size
        done = 0
        while done < size:
            sent = os.copy_file_range(source.fileno(), target.fileno(), size - done)
            if sent == 0:
                break
            done += sent
        if done == size:
            return
    except (OSError, AttributeError):
        pass
    source.seek(0)
    target.seek(0)
    target.truncate()
    shutil.copyfileobj(source, target, 1 << 20)
