"""SHA-256 of archives and folders, remembered as long as names, sizes and times stay the same."""

from __future__ import annotations

import hashlib
import json
import os
from typing import TYPE_CHECKING

from simworlds.files import sha256_of_file, write_whole
from simworlds.folder_files import read_file

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from simworlds.folder_files import FolderFiles


class Digests:
    """Digests cached in one JSON file; a cache that cannot be read counts as empty."""

    def __init__(self, memory: Path) -> None:
        self._memory = memory
        self._known = _read(memory)
        self._changed = False

    def of_file(self, path: Path) -> str:
        """SHA-256 of a file's content, in hexadecimal digits. Raises OSError."""

        return self._recall(path, _signature(path.stat()), lambda: sha256_of_file(path))

    def of_files(self, files: FolderFiles) -> str:
        """SHA-256 over the names and contents of files beneath a folder. Raises OSError."""
        listing = hashlib.sha256()
        for file in files.files:
            line = f"{file.name}\0{file.size}:{file.changed}:{file.inode}\n"
            listing.update(line.encode(errors="surrogateescape"))

        def compute() -> str:
            digest = hashlib.sha256()
            for file in files.files:
                content = read_file(files.folder, file.name, most=file.size, cut=True)
                line = f"{file.name}\0{hashlib.sha256(content).hexdigest()}\n"
                digest.update(line.encode(errors="surrogateescape"))
            return digest.hexdigest()

        return self._recall(files.folder, listing.hexdigest(), compute)

    def save(self) -> None:
        """Writes the cache; a cache that cannot be written is computed again next time."""
        if not self._changed:
            return
        try:
            write_whole(self._memory, json.dumps(self._known), durable=False)
        except OSError:
            return
        self._changed = False

    def _recall(self, path: Path, signature: str, compute: Callable[[], str]) -> str:
        key = os.fspath(path.absolute())
        known = self._known.get(key)
        if known is not None and known[0] == signature:
            return known[1]
        digest = compute()
        self._known[key] = (signature, digest)
        self._changed = True
        return digest


def _signature(status: os.stat_result) -> str:
    return f"{status.st_size}:{status.st_mtime_ns}:{status.st_ino}"


def _read(memory: Path) -> dict[str, tuple[str, str]]:
    try:
        data = json.loads(memory.read_text(encoding="utf-8"))
        return {str(key): (str(signature), str(digest)) for key, (signature, digest) in data.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}
