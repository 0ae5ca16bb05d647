"""When a session has to stop: the user asks for it, or its limit of minutes is reached."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from agents.loop.errors import Stopping

if TYPE_CHECKING:
    import threading

_KEPT_BACK = 120.0  # seconds of a limit, for saving and showing what stands
_KEPT_BACK_SHARE = 0.1  # of a limit, which that may take at most


@dataclass(frozen=True, slots=True)
class Deadline:
    """What ends a session before its work is done.

    ``asked`` is set once the user wants to stop. ``max_minutes``: the limit, if any, from ``began`` on, a time of
    ``time.monotonic``.
    """

    asked: threading.Event
    max_minutes: float | None = None
    began: float = field(default_factory=time.monotonic)

    def check(self) -> None:
        """A safe point: called before everything that costs time or money. Raises Stopping."""
        if self.asked.is_set():
            raise Stopping("You asked the run to stop.")
        left = self.seconds_left
        if left is not None and left < 0:
            raise Stopping(f"The limit of {self.max_minutes:g} minutes is reached.")

    @property
    def seconds_left(self) -> float | None:
        """Until the limit, without what is kept back for saving and showing the scene; None without a limit."""
        if self.max_minutes is None:
            return None
        return self.max_minutes * 60 - self.seconds_kept_back - (time.monotonic() - self.began)

    @property
    def seconds_kept_back(self) -> float:
        """What of the limit is kept back for saving and showing what stands."""
        if self.max_minutes is None:
            return _KEPT_BACK
        return min(_KEPT_BACK, self.max_minutes * 60 * _KEPT_BACK_SHARE)
