"""A process that is looked at from outside: what it uses, and standing still while that is counted."""

from __future__ import annotations

import os
import signal
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator


class WatchedProcess:
    """The process of this number; 0: none, of which everything is 0."""

    def __init__(self, number: int) -> None:
        self.number = number

    def memory_and_threads(self) -> tuple[int, int]:
        """(bytes of memory not backed by a file, number of threads); 0 where that cannot be known."""
        values = self._status()
        try:
            memory = sum(int(values[name].split()[0]) for name in ("RssAnon", "RssShmem"))
            return memory * 1024, int(values["Threads"])
        except (LookupError, ValueError):
            return 0, 0

    @contextmanager
    def standing_still(self) -> Generator[None]:
        """Stops the process meanwhile, unless it is stopped already."""
        if not self.number or self._status().get("State", "").startswith(("T", "Z", "X")):
            yield
            return
        with suppress(OSError):
            os.kill(self.number, signal.SIGSTOP)
        try:
            yield
        finally:
            with suppress(OSError):
                os.kill(self.number, signal.SIGCONT)

    def _status(self) -> dict[str, str]:
        if not self.number:
            return {}
        try:
            lines = Path(f"/proc/{self.number}/status").read_text().splitlines()
        except OSError:
            return {}
        return dict(line.split(":\t", 1) for line in lines if ":\t" in line)
