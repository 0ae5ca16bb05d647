"""A folder that one process at a time works in."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from simworlds.operating_system import SYSTEM
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path


@contextmanager
def locked(folder: Path, *, before_waiting: Callable[[], None] | None = None) -> Generator[None]:
    """Holds a folder for this process.

    While another one has it, ``before_waiting`` is called and the folder waited for; without it, Refusal is raised.
    Raises OSError where the folder cannot be written to.
    """
    with (folder / ".lock").open("w") as file:
        try:
            SYSTEM.lock(file, wait=False)
        except OSError as error:
            if before_waiting is None:
                raise Refusal(f"{folder} is in use by another SimWorlds. Choose another folder.") from error
            before_waiting()
            SYSTEM.lock(file, wait=True)
        yield
