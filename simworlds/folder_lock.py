"""A folder that one process at a time works in."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from simworlds.operating_system import SYSTEM
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path

# The folder may be somebody else's: its lock must not lead to a file elsewhere, nor is anything in one lost.
_OPENED = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)


@contextmanager
def locked(folder: Path, *, before_waiting: Callable[[], None] | None = None) -> Generator[None]:
    """Holds a folder for this process.

    While another one has it, ``before_waiting`` is called and the folder waited for; without it, Refusal is raised.
    Raises OSError where the folder cannot be written to.
    """
    with os.fdopen(os.open(folder / ".lock", _OPENED, 0o666), "r+b", buffering=0) as file:
        try:
            SYSTEM.lock(file, wait=False)
        except OSError as error:
            if before_waiting is None:
                raise Refusal(f"{folder} is in use by another SimWorlds. Choose another folder.") from error
            before_waiting()
            SYSTEM.lock(file, wait=True)
        yield
