"""A folder that one process at a time works in."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from simworlds.operating_system import SYSTEM
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path


@contextmanager
def locked(folder: Path) -> Generator[None]:
    """Holds a folder for this process. Raises Refusal while another one has it."""
    with (folder / ".lock").open("w") as file:
        try:
            SYSTEM.lock(file, wait=False)
        except OSError as error:
            raise Refusal(f"{folder} is in use by another SimWorlds. Choose another folder.") from error
        yield
