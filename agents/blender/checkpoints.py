"""The states of a run that Blender can be put back to.

Policy. A small scene is written out after every call that may have changed it: a few milliseconds. Where writing
takes longer than ``CHEAP_SECONDS``, it waits until the calls since the last checkpoint have run ``PATIENCE`` times as
long as writing takes, so that at most a fifth of the time goes into checkpoints; what was done since is then lost with
a crash, and the error says how many calls. Saving, loading, baking, and code that asks to be undone when it fails,
always leave or find a fresh checkpoint. The newest ``KEPT`` stay; where they come to more than ``KEPT_BYTES``, fewer
do, but never fewer than ``KEPT_LEAST``.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

from simworlds.sandbox.untrusted_files import take_beneath

if TYPE_CHECKING:
    from pathlib import Path

    from agents.blender.run_folder import RunFolder

CHEAP_SECONDS = 0.25
PATIENCE = 4.0
KEPT = 12
KEPT_LEAST = 3
KEPT_BYTES = 4 << 30
WRITTEN = "checkpoint.blend"  # in the private folder, until it is taken in
_FILE = re.compile(r"(\d{6})\.blend")


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """A state that was written out: ``number`` counts from 1, ``after`` tells what had been done."""

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
            _found(int(match[1]), path, "kept from before")
            for path in sorted(folder.checkpoints.glob("*.blend"))
            if (match := _FILE.fullmatch(path.name))
        ]
        self._cost = 0.0
        self._worked = 0.0
        self.unkept = 0

    @property
    def last(self) -> Checkpoint | None:
        """The newest."""
        return self._all[-1] if self._all else None

    def newest_first(self) -> list[Checkpoint]:
        """All of them."""
        return self._all[::-1]

    def find(self, number: int) -> Checkpoint | None:
        """The one of that number, if it is still kept."""
        return next((one for one in self._all if one.number == number), None)

    def changed(self, seconds: float) -> None:
        """A call that may have changed the scene has run for ``seconds``."""
        self._worked += seconds
        self.unkept += 1

    @property
    def due(self) -> bool:
        """Whether the changes since the last one are worth another."""
        return self.unkept > 0 and (self._cost <= CHEAP_SECONDS or self._worked >= PATIENCE * self._cost)

    def keep(self, after: str, seconds: float) -> Checkpoint:
        """Takes in the state that Blender wrote to WRITTEN within ``seconds``. Raises Refusal."""
        started = time.monotonic()
        number = self._all[-1].number + 1 if self._all else 1
        path = self._folder.checkpoints / f"{number:06d}.blend"
        take_beneath(self._folder.private, WRITTEN, path, durable=False)
        self._all.append(_found(number, path, after))
        self._cost, self._worked, self.unkept = seconds + time.monotonic() - started, 0.0, 0
        self._drop_oldest()
        return self._all[-1]

    def _drop_oldest(self) -> None:
        while len(self._all) > KEPT or (
            len(self._all) > KEPT_LEAST and sum(one.bytes for one in self._all) > KEPT_BYTES
        ):
            self._all.pop(0).path.unlink(missing_ok=True)

    def returned(self) -> None:
        """Blender stands where the last checkpoint does."""
        self._worked, self.unkept = 0.0, 0


def _found(number: int, path: Path, after: str) -> Checkpoint:
    there = path.stat()
    return Checkpoint(number, path, after, datetime.fromtimestamp(there.st_mtime).astimezone(), there.st_size)
