"""Claude, or any server that speaks Anthropic's Messages API.

Answers are streamed. After a passing fault (no connection, an overloaded server, a stream that breaks anywhere) the
request is retried; any other is a ModelError at once. Ctrl-C ends the call at once.
"""

from __future__ import annotations

import itertools
import os
import random
import time
from contextlib import closing
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

import httpx2
from anthropic import Anthropic, APIStatusError

from simworlds.llm.errors import ModelError, Rejected, TooLong, Unreachable, raise_for_stop
from simworlds.llm.messages import Usage
from simworlds.llm.prices import Prices
from simworlds.llm.request import params_of
from simworlds.llm.retries import (
    FAULTS,
    Retry,
    RetryPolicy,
    describe_fault,
    is_lasting,
    is_midstream,
    requested_pause,
)
from simworlds.llm.stream import LimitedBytes, StreamedAnswer

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from simworlds.llm.messages import Ask, Turn

_CONNECT_SECONDS = 10.0
_ADVICE = {
    401: " Check the key (ANTHROPIC_API_KEY).",
    402: " Check the account's credit.",
    403: " Check that the key may use this model.",
    404: " Check the model's name.",
}
_TOO_LONG = ("prompt is too long", "exceed context limit", "too many tokens")


@dataclass(frozen=True, slots=True)
class Settings:
    """How to reach Claude.

    ``api_key`` and ``base_url`` default to the environment's ANTHROPIC_API_KEY (or ANTHROPIC_AUTH_TOKEN) and
    ANTHROPIC_BASE_URL. An answer may pause for ``silence`` seconds, and take ``longest`` seconds in all.
    """

    api_key: str | None = None
    base_url: str | None = None
    silence: float = 180.0
    longest: float = 1800.0
    patience: RetryPolicy = field(default_factory=RetryPolicy)
    prices: Prices = field(default_factory=Prices)


class _Fault(Exception):  # noqa: N818 - sets faults of the server apart from errors of the caller's own code
    def __init__(self, error: Exception) -> None:
        self.error = error
        super().__init__(str(error))


class Claude:
    """A Model. Safe to call from several threads at once."""

    def __init__(
        self,
        settings: Settings | None = None,
        tell: Callable[[Retry], object] | None = None,
        *,
        pause: Callable[[float], object] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
        chance: random.Random | None = None,
    ) -> None:
        """``tell`` is called before every Retry; what it raises ends the call. Raises Rejected without a key."""
        self._settings = settings or Settings()
        self._tell = tell
        self._pause = pause
        self._clock = clock
        self._chance = chance or random.Random()  # noqa: S311 - spreads pauses
        self._client = _client(self._settings)
        self._heard = False

    @property
    def address(self) -> str:
        """Where requests go."""
        return str(self._client.base_url)

    def close(self) -> None:
        """Closes the connections."""
        self._client.close()

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn, see Model. Raises Rejected, TooLong, Unreachable, Declined, CutShort."""
        lost: list[Usage] = []
        for failed in itertools.count(1):
            answer = StreamedAnswer()
            try:
                with closing(self._read(ask, answer)) as texts:
                    for text in texts:
                        if text and on_text:
                            on_text(text)
            except _Fault as fault:
                lost.append(answer.usage())
                self._wait(ask, failed, fault.error, lost)
            else:
                return raise_for_stop(self._priced(answer.turn(), ask, lost))
        raise AssertionError("unreachable")

    def _read(self, ask: Ask, answer: StreamedAnswer) -> Generator[str]:
        """Reads a whole answer, and yields its words as they come. Raises _Fault for all that a server can do."""
        try:
            with self._client.messages.stream(**params_of(ask)) as events:
                self._heard = True
                response = events.response
                assert isinstance(response.stream, httpx2.SyncByteStream)
                response.stream = LimitedBytes(response.stream, self._settings.longest, self._clock)
                yield from answer.read(events)
            answer.turn()
        except FAULTS as error:
            raise _Fault(error) from error

    def _wait(self, ask: Ask, failed: int, error: Exception, lost: list[Usage]) -> None:
        """Waits until the request may be sent again. Raises Rejected, TooLong, Unreachable."""
        used = sum(lost, Usage())
        if is_lasting(error):
            raise _with(used, self._rejected(error)) from error
        patience = self._settings.patience
        self._heard = self._heard or isinstance(error, APIStatusError)
        tries = patience.tries if self._heard else min(patience.unheard, patience.tries)
        requested = requested_pause(error)
        if failed >= tries or requested > patience.most_asked:
            why = f"{failed} times in a row" if failed >= tries else f"it asks to wait {requested:.0f} s"
            message = f"No answer from {self.address}: {describe_fault(error)} ({why})."
            raise _with(used, Unreachable(message)) from error
        retry = Retry(
            ask, failed, describe_fault(error), patience.pause(failed, requested, self._chance), used
        )
        if self._tell:
            self._tell(retry)
        self._pause(retry.pause)

    def _rejected(self, error: Exception) -> Rejected:
        status = error.status_code if isinstance(error, APIStatusError) and not is_midstream(error) else 0
        words = describe_fault(error)
        if status == 413 or any(sign in words for sign in _TOO_LONG):
            return TooLong(f"The conversation is too long for the model: {words}.", status)
        advice = _ADVICE.get(status, "")
        return Rejected(f"{self.address} rejects the request: {words}.{advice}", status)

    def _priced(self, turn: Turn, ask: Ask, lost: list[Usage]) -> Turn:
        costs = [self._settings.prices.cost(ask.model, usage) for usage in (turn.usage, *lost)]
        known = [cost for cost in costs if cost is not None]
        cost = sum(known) if len(known) == len(costs) else None
        return replace(turn, cost=cost, lost=sum(lost, Usage()))


_E = TypeVar("_E", bound=ModelError)


def _with(lost: Usage, error: _E) -> _E:
    error.lost = lost
    return error


def _client(settings: Settings) -> Anthropic:
    """The package's client, without its own retries: it does not report them, nor retry broken streams."""
    key = (settings.api_key or os.environ.get("ANTHROPIC_API_KEY") or "").strip()
    token = "" if key else os.environ.get("ANTHROPIC_AUTH_TOKEN", "").strip()
    if not key and not token:
        raise Rejected(
            "There is no key for the model: set ANTHROPIC_API_KEY (to any word for a server that needs none)."
        )
    if not (key + token).isascii() or not (key + token).isprintable():
        raise Rejected(
            "ANTHROPIC_API_KEY contains characters that are not allowed in keys. Copy the key again."
        )
    timeout = httpx2.Timeout(settings.silence, connect=min(settings.silence, _CONNECT_SECONDS))
    try:
        client = Anthropic(
            api_key=key or None,
            auth_token=token or None,
            base_url=settings.base_url,
            timeout=timeout,
            max_retries=0,
        )
    except (httpx2.InvalidURL, ValueError) as error:
        raise Rejected(
            f"The address of the model (ANTHROPIC_BASE_URL) or of a proxy is invalid: {error}."
        ) from error
    if client.base_url.scheme not in ("http", "https") or not client.base_url.host:
        raise Rejected(
            f"The address of the model (ANTHROPIC_BASE_URL) is not an HTTP URL: {client.base_url}."
        )
    return client
