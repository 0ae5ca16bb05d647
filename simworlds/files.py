"""Files and folders that appear whole or not at all, and the SHA-256 of a file."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import tempfile
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.operating_system import SYSTEM

if TYPE_CHECKING:
    from collections.abc import Generator

_PREFIX = ".unfinished-"
_PART = re.compile(r"\..+\.(\d+)(-\d+)?\.part")


@contextmanager
def staged_folder(target: Path) -> Generator[Path]:
    """A new folder beside ``target`` that becomes ``target`` when the body ends well, and vanishes otherwise.

    Vanishes on Ctrl-C too; what a killed process left is removed by the next call. Where another process has
    made ``target`` meanwhile, that one stays. Raises OSError when the disk refuses.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    remove_leftovers(target.parent)
    folder = Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{os.getpid()}-", dir=target.parent))
    try:
        folder.chmod(0o755)
        yield folder
        try:
            folder.rename(target)
        except OSError:
            if not target.is_dir():
                raise
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def scratch_folder(parent: Path) -> Generator[Path]:
    """A new folder below ``parent`` that vanishes afterwards; what a killed process left there goes first.

    Raises OSError when the disk refuses.
    """
    parent.mkdir(parents=True, exist_ok=True)
    remove_leftovers(parent)
    folder = Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{os.getpid()}-", dir=parent))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def staged_file(target: Path) -> Generator[Path]:
    """A path beside ``target`` to write to; it becomes ``target`` when the body ends well, else it vanishes.

    Raises OSError when the disk refuses.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name}.{os.getpid()}-{threading.get_ident()}.part")
    part.unlink(missing_ok=True)
    try:
        yield part
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes | str, *, durable: bool = True) -> None:
    """Writes a file so that whoever reads it, whenever this ends, finds the old one or the new one.

    Text is written as UTF-8. ``durable`` waits for the disk. Raises OSError.
    """
    data = content.encode() if isinstance(content, str) else content
    with staged_file(path) as part, part.open("wb") as file:
        file.write(data)
        if durable:
            file.flush()
            os.fsync(file.fileno())


def remove_unfinished_files(folder: Path) -> None:
    """Remove what processes that no longer run left of files that they were writing in ``folder``."""
    with contextlib.suppress(OSError):
        for path in list(folder.iterdir()):
            match = _PART.match(path.name)
            if match and not SYSTEM.is_running(int(match[1])):
                path.unlink(missing_ok=True)


def remove_leftovers(parent: Path) -> None:
    """Remove what killed processes left in ``parent`` of their scratch folders and of folders that they staged."""
    for folder in parent.glob(f"{_PREFIX}*"):
        pid = folder.name.removeprefix(_PREFIX).partition("-")[0]
        if pid.isdigit() and not SYSTEM.is_running(int(pid)):
            shutil.rmtree(folder, ignore_errors=True)


def sha256_of_file(path: Path) -> str:
    """SHA-256 of a file's content, in hexadecimal digits. Raises OSError."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
