"""Which faults pass, and how long to wait for them."""

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
"""What asking can raise through a server's fault; of these, ``lasting`` tells those that do not pass."""

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
class Patience:
    """How often in a row the server may fail, and how long to wait for it (seconds).

    ``unheard`` failures end it where no server has ever answered: then the address is wrong rather than busy. A server
    that wants more than ``most_asked`` seconds is not waited for.
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
    """Told before a request is sent again: the ``failed``-th failure, why, and the seconds until then.

    ``lost`` is what all failed attempts at ``ask`` have used up so far, as far as it is known.
    """

    ask: Ask
    failed: int
    why: str
    pause: float
    lost: Usage = field(default_factory=Usage)

    def __str__(self) -> str:
        return f"{self.why}; asking again in {self.pause:.0f} s"


def lasting(error: Exception) -> bool:
    """Whether a fault of ``FAULTS`` would be the same another time."""
    if not isinstance(error, APIStatusError):
        return False
    if is_midstream(error):
        return error.type in _LASTING
    told = error.response.headers.get("x-should-retry")
    if told in ("true", "false"):
        return told == "false"
    return not (error.status_code in (408, 409, 429) or error.status_code >= 500)


def is_midstream(error: APIStatusError) -> bool:
    """Whether the server failed after it had begun to answer; ``error.type`` says how, the status does not."""
    return error.status_code < 400


def asked_pause(error: Exception) -> float:
    """The seconds that the server asks to be left alone; 0 where it does not."""
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


def in_words(error: Exception) -> str:
    """A fault for people, in a line."""
    if isinstance(error, APIStatusError):
        words = error.api_message or error.message
        status = f"the server broke off with {error.type}:" if is_midstream(error) else error.status_code
        said = f"{status} {words}"
    elif isinstance(error, BrokenStream):
        said = f"the answer is not whole: {error}"
    else:
        # The package wraps what the network raised in words of its own.
        cause = (isinstance(error, AnthropicError) and error.__cause__) or error
        said = f"{type(cause).__name__}: {cause}" if str(cause) else type(cause).__name__
    return " ".join(said.split())[:_LONGEST_WORDS]
