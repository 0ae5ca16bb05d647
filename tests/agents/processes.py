"""Which processes belong to a run, found by what it gave them: their folder and their environment."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def of_run(root: Path) -> list[int]:
    """The processes of the run in ``root``: Blender, and what confines it."""
    marker = os.fsencode(root / "private")
    found: list[int] = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            given = (folder / "environ").read_bytes()
            place = (folder / "cwd").readlink()
        except OSError:
            continue
        if marker in given or place.is_relative_to(root):
            found.append(int(folder.name))
    return [number for number in found if number != os.getpid()]


def becomes(condition: Callable[[], bool], seconds: float = 60.0) -> bool:
    """Whether a condition comes true within ``seconds``."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.005)
    return True


def has_ended(pid: int | None) -> bool:
    """Whether a process is gone, or waits only for its parent to notice."""
    try:
        return "Z" in Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2]
    except (FileNotFoundError, ProcessLookupError):
        return True
