"""Checkpoints: states of a run that Blender can go back to.

A small scene is written after every call that may have changed it, which takes milliseconds. If writing takes longer
than ``CHEAP_SECONDS``, it waits until the calls since the last checkpoint have run ``PATIENCE`` times as long as
writing takes, so that checkpoints cost at most a fifth of the time. A crash then loses the calls since, and the error
says how many. Saving, loading, baking, and code that is to be undone on failure, always have a fresh checkpoint. The
newest ``KEPT`` stay; fewer if they exceed ``KEPT_BYTES``, but at least ``KEPT_LEAST``.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from agents.blender.files.run_folder import RunFolder

CHEAP_SECONDS = 0.25
PATIENCE = 4.0
KEPT = 12
KEPT_LEAST = 3
KEPT_BYTES = 4 << 30
_FILE = re.compile(r"(\d{6})\.blend")


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """A state that was written to ``path``: ``number`` counts from 1, ``after`` says what was done before."""

    number: int
    path: Path
    after: str
    taken: datetime
    bytes: int

    def __str__(self) -> str:
        return f"checkpoint {self.number} ({self.after}, {self.taken:%H:%M:%S})"


class Checkpoints:
    """The checkpoints of a run, oldest first, and whether another one is due."""

    def __init__(self, folder: RunFolder) -> None:
        self._folder = folder
        for half in folder.checkpoints.glob(".*.part"):
            half.unlink(missing_ok=True)
        self._all = [
            _checkpoint(int(match[1]), path, "kept from before")
            for path in sorted(folder.checkpoints.glob("*.blend"))
            if (match := _FILE.fullmatch(path.name))
        ]
        self._cost = 0.0
        self._worked = 0.0
        self.unkept = 0

    @property
    def last(self) -> Checkpoint | None:
        """The newest checkpoint."""
        return self._all[-1] if self._all else None

    def newest_first(self) -> list[Checkpoint]:
        """All checkpoints, newest first."""
        return self._all[::-1]

    def find(self, number: int) -> Checkpoint | None:
        """The checkpoint of that number; None if it is no longer kept."""
        return next((checkpoint for checkpoint in self._all if checkpoint.number == number), None)

    def changed(self, seconds: float) -> None:
        """Notes that a call of ``seconds`` may have changed the scene."""
        self._worked += seconds
        self.unkept += 1

    @property
    def due(self) -> bool:
        """Whether the changes since the last checkpoint are worth a new one."""
        return self.unkept > 0 and (self._cost <= CHEAP_SECONDS or self._worked >= PATIENCE * self._cost)

    @property
    def cost(self) -> float:
        """Seconds that the last one took."""
        return self._cost

    def keep(self, written: str, after: str, seconds: float) -> Checkpoint:
        """Adds the state that Blender wrote in ``seconds`` as ``written`` in the private folder. Raises Refusal."""
        started = time.monotonic()
        number = self._all[-1].number + 1 if self._all else 1
        path = self._folder.checkpoints / f"{number:06d}.blend"
        self._folder.private.take(written, path, durable=False)
        self._all.append(_checkpoint(number, path, after))
        self._cost, self._worked, self.unkept = seconds + time.monotonic() - started, 0.0, 0
        self._drop_oldest()
        return self._all[-1]

    def _drop_oldest(self) -> None:
        while len(self._all) > KEPT or (
            len(self._all) > KEPT_LEAST and sum(checkpoint.bytes for checkpoint in self._all) > KEPT_BYTES
        ):
            self._all.pop(0).path.unlink(missing_ok=True)

    def returned(self) -> None:
        """Notes that the scene is that of the last checkpoint."""
        self._worked, self.unkept = 0.0, 0


def _checkpoint(number: int, path: Path, after: str) -> Checkpoint:
    status = path.stat()
    return Checkpoint(
        number, path, after, datetime.fromtimestamp(status.st_mtime).astimezone(), status.st_size
    )
