"""Digests of files and of data, by which steps and results are identified."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from typing import TYPE_CHECKING, Any

from simworlds.files import sha256_of_file

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


def digest_of(value: Any) -> str:
    """SHA-256 of data that JSON can hold; the order of keys does not matter."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def digest_of_bytes(content: bytes) -> str:
    """SHA-256 of some bytes."""
    return hashlib.sha256(content).hexdigest()


def digests(folder: Path, files: Iterable[Path]) -> dict[str, str]:
    """{path below ``folder``: SHA-256} of its ``files``, sorted. Raises OSError."""
    result: dict[str, str] = {}
    for path in sorted(files):
        stat = path.stat()
        result[path.relative_to(folder).as_posix()] = _digest(path, stat.st_size, stat.st_mtime_ns)
    return result


@cache
def _digest(path: Path, size: int, changed: int) -> str:
    """The digest of a file, computed once in each process: many scenes share files."""
    del size, changed
    return sha256_of_file(path)


def files_below(folder: Path) -> list[Path]:
    """The plain files below a folder, sorted; links to folders are not followed."""
    return sorted(path for path in folder.rglob("*") if path.is_file())
