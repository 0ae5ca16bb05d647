"""Which faults are worth a retry, and how long to wait before it."""

from __future__ import annotations

import email.utils
import json
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import httpx2
from anthropic import AnthropicError, APIStatusError

from simworlds.llm.messages import Usage
from simworlds.llm.stream import BrokenStream

if TYPE_CHECKING:
    import random

    from simworlds.llm.messages import Ask

FAULTS = (
    AnthropicError,
    httpx2.HTTPError,
    httpx2.StreamError,
    httpx2.InvalidURL,  # a redirection to nowhere
    json.JSONDecodeError,
    UnicodeDecodeError,
    BrokenStream,
)
"""What a request can raise through a fault of the server; ``is_lasting`` tells those not worth a retry."""

_LASTING = (
    "invalid_request_error",
    "authentication_error",
    "billing_error",
    "permission_error",
    "not_found_error",
    "request_too_large",
)
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


def is_lasting(error: Exception) -> bool:
    """Whether a fault of ``FAULTS`` would occur again."""
    if not isinstance(error, APIStatusError):
        return False
    if is_midstream(error):
        return error.type in _LASTING
    should_retry = error.response.headers.get("x-should-retry")
    if should_retry in ("true", "false"):
        return should_retry == "false"
    return not (error.status_code in (408, 409, 429) or error.status_code >= 500)


def is_midstream(error: APIStatusError) -> bool:
    """Whether the server failed after it had begun to answer; ``error.type`` says how, the status does not."""
    return error.response.is_success


def requested_pause(error: Exception) -> float:
    """The seconds that the server asks to wait; 0 if it does not."""
    if not isinstance(error, APIStatusError):
        return 0.0
    headers = error.response.headers
    for name, scale in (("retry-after-ms", 0.001), ("retry-after", 1.0)):
        try:
            seconds = float(headers.get(name, "")) * scale
        except ValueError:
            continue
        return seconds if 0 <= seconds < float("inf") else 0.0
    try:
        until = email.utils.parsedate_to_datetime(headers.get("retry-after", ""))
    except ValueError:
        return 0.0
    return max(0.0, until.timestamp() - time.time())


def describe_fault(error: Exception) -> str:
    """Describes a fault in one line."""
    if isinstance(error, APIStatusError):
        words = error.api_message or error.message
        status = f"the server broke off with {error.type}:" if is_midstream(error) else error.status_code
        text = f"{status} {words}"
    elif isinstance(error, BrokenStream):
        text = f"the answer is incomplete: {error}"
    else:
        # The package hides what the network raised behind its own words.
        cause = (isinstance(error, AnthropicError) and error.__cause__) or error
        text = f"{type(cause).__name__}: {cause}" if str(cause) else type(cause).__name__
    return " ".join(text.split())[:_LONGEST_WORDS]
