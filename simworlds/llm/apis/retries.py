"""Which faults are worth a retry, and how long to wait before it."""

from __future__ import annotations

import email.utils
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from simworlds.llm.messages import Usage

if TYPE_CHECKING:
    import random
    from collections.abc import Mapping

    from simworlds.llm.messages import Ask

_LONGEST_WORDS = 300


@dataclass(frozen=True, slots=True)
class RetryPolicy:
    """How often in a row the server may fail, and how long to wait for it (seconds).

    If no server has ever answered, ``unheard`` failures are enough: then the address is wrong rather than busy. A
    server that asks for more than ``most_asked`` seconds is given up.
    """

    tries: int = 8
    unheard: int = 3
    first_pause: float = 1.0
    longest_pause: float = 60.0
    most_asked: float = 300.0

    def pause(self, failed: int, asked: float, chance: random.Random) -> float:
        """Seconds to wait after the ``failed``-th failure: twice as long each time, spread, and no less than asked."""
        longest = min(self.longest_pause, self.first_pause * 2 ** min(failed - 1, 30))
        spread = longest * chance.uniform(0.5, 1.0)
        return max(spread, asked + self.first_pause * chance.random() if asked else 0.0)


@dataclass(frozen=True, slots=True)
class Retry:
    """A retry to come: after the ``failed``-th failure, for the reason ``why``, in ``pause`` seconds.

    ``lost`` is what all failed attempts at ``ask`` have used so far, as far as it is known.
    """

    ask: Ask
    failed: int
    why: str
    pause: float
    lost: Usage = field(default_factory=Usage)

    def __str__(self) -> str:
        return f"{self.why}; asking again in {self.pause:.0f} s"


def is_passing(status: int, headers: Mapping[str, str]) -> bool:
    """Whether an error reply with this status may be another at the next attempt."""
    should_retry = headers.get("x-should-retry")
    if should_retry in ("true", "false"):
        return should_retry == "true"
    return status in (408, 409, 429) or status >= 500


def requested_pause(headers: Mapping[str, str]) -> float:
    """The seconds that the server asks to wait; 0 if it does not."""
    for name, scale in (("retry-after-ms", 0.001), ("retry-after", 1.0)):
        try:
            seconds = float(headers.get(name, "")) * scale
        except ValueError:
            continue
        return seconds if 0 <= seconds < float("inf") else 0.0
    try:
        until = email.utils.parsedate_to_datetime(headers.get("retry-after", "")).timestamp()
    except (ValueError, OverflowError):  # the latter where the last year is no time of this zone
        return 0.0
    return max(0.0, until - time.time())


def one_line(words: str) -> str:
    """Words of a server as one line of limited length."""
    return " ".join(words.split())[:_LONGEST_WORDS]
