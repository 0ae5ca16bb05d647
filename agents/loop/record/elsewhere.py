"""Runs in folders that their users chose: where these are, so that they are listed too.

Each is a file of its own, named after its path: processes that begin runs at the same time write different files, so
none needs to wait for another, and none loses what another wrote.
"""

from __future__ import annotations

import hashlib
import os
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from agents.blender.launch import runs_folder
from agents.loop.record.journal import NAME
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Generator

_FOLDER = "runs-elsewhere"  # beside the runs' folder
_MOST = 200  # places that are kept, those worked on last
_LONGEST = 8192  # bytes of a path


@contextmanager
def remembered(root: Path) -> Generator[None]:
    """Has the run in ``root`` listed from now on, unless nothing has become of it by the end."""
    _remember(root)
    try:
        yield
    finally:
        if (root / NAME).is_file():
            _remember(root)
        else:
            _forget(_entry(root))


def runs_elsewhere() -> list[Path]:
    """The runs outside the runs' folder, those worked on last first. Forgets those whose folder is gone."""
    dated: list[tuple[float, Path]] = []
    for entry in _entries():
        with suppress(OSError):  # not to be looked at now, as another user's, or without a journal yet
            with entry.open("rb") as file:
                root = Path(os.fsdecode(file.read(_LONGEST)))
            if root.is_dir():
                dated.append(((root / NAME).stat().st_mtime, root))
            else:
                _forget(entry)
    return [root for _, root in sorted(dated, reverse=True)]


def _remember(root: Path) -> None:
    if root.parent == runs_folder():
        return
    with suppress(OSError):  # a run goes on without being listed
        write_whole(_entry(root), os.fsencode(root), durable=False)
    for entry in _entries()[_MOST:]:
        _forget(entry)


def _forget(entry: Path) -> None:
    with suppress(OSError):  # it is gone already, or stays
        entry.unlink()


def _entry(root: Path) -> Path:
    return runs_folder().with_name(_FOLDER) / hashlib.sha256(os.fsencode(root)).hexdigest()[:32]


def _entries() -> list[Path]:
    """The files of all places, those written last first."""
    dated: list[tuple[float, Path]] = []
    with suppress(OSError):
        for entry in runs_folder().with_name(_FOLDER).iterdir():
            if not entry.name.startswith("."):
                with suppress(OSError):  # another process has just removed it
                    dated.append((entry.stat().st_mtime, entry))
    return [entry for _, entry in sorted(dated, reverse=True)]
