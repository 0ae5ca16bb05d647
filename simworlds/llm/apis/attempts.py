"""Asks a server until an answer is whole: the same for every API.

After a passing fault (no connection, an overloaded server, a stream that breaks anywhere) the request is retried; any
other is a ModelError at once. Ctrl-C ends the call at once.
"""

from __future__ import annotations

import itertools
import random
import time
from contextlib import closing
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol, TypeVar

from simworlds.llm.apis.retries import Retry, RetryPolicy
from simworlds.llm.errors import ModelError, Rejected, TooLong, Unreachable, raise_for_stop
from simworlds.llm.messages import Usage
from simworlds.llm.prices import Prices

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator

    from simworlds.llm.messages import Ask, Turn

CONNECT_SECONDS = 10.0
_TOO_LONG = (
    "prompt is too long",
    "exceed context limit",
    "too many tokens",
    "context_length_exceeded",
    "maximum context length",
)


@dataclass(frozen=True, slots=True)
class Settings:
    """How to reach a server.

    ``api_key`` and ``base_url`` default to the environment's. An answer may pause for ``silence`` seconds, and take
    ``longest`` seconds in all.
    """

    api_key: str | None = None
    base_url: str | None = None
    silence: float = 180.0
    longest: float = 1800.0
    patience: RetryPolicy = field(default_factory=RetryPolicy)
    prices: Prices = field(default_factory=Prices)


@dataclass(frozen=True, slots=True)
class Fault:
    """What a server did wrong, in one line.

    ``status`` is HTTP's, 0 without one. ``is_lasting``: it would happen again. ``requested_pause``: the seconds that
    the server asks to wait.
    """

    words: str
    status: int = 0
    is_lasting: bool = False
    requested_pause: float = 0.0


class Attempt(Protocol):
    """One attempt at an answer, which grows while it is read."""

    def read(self) -> Iterator[str]:
        """Reads until the answer is whole, and yields what people may read of it."""
        ...

    def turn(self) -> Turn:
        """The whole answer, without its cost; raises where it is not whole."""
        ...

    def usage(self) -> Usage:
        """The tokens so far."""
        ...

    def fault_of(self, error: Exception) -> Fault | None:
        """The fault of the server that an error of this attempt tells of; None for an error of ours."""
        ...


class Api(Protocol):
    """A server, as one of the packages reaches it."""

    def close(self) -> None:
        """Closes the connections."""
        ...

    @property
    def address(self) -> str:
        """Where requests go."""
        ...

    @property
    def advice(self) -> dict[int, str]:
        """What to do about a status."""
        ...

    def attempt(self, ask: Ask) -> Attempt:
        """A new attempt; nothing is sent before it is read."""
        ...


class _ServerFault(Exception):  # noqa: N818 - sets faults of the server apart from errors of the caller's own code
    def __init__(self, fault: Fault, error: Exception) -> None:
        self.fault, self.error = fault, error
        super().__init__(fault.words)


class Attempts:
    """A Model of an Api, with retries, prices and errors. Safe to call from several threads at once."""

    def __init__(
        self,
        api: Api,
        settings: Settings,
        tell: Callable[[Retry], object] | None = None,
        *,
        pause: Callable[[float], object] = time.sleep,
        chance: random.Random | None = None,
    ) -> None:
        """``tell`` is called before every Retry; what it raises ends the call."""
        self._api = api
        self._settings = settings
        self._tell = tell
        self._pause = pause
        self._chance = chance or random.Random()  # noqa: S311 - spreads pauses
        self._heard = False

    @property
    def address(self) -> str:
        """Where requests go."""
        return self._api.address

    def close(self) -> None:
        """Closes the connections."""
        self._api.close()

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn, see Model. Raises Rejected, TooLong, Unreachable, Declined, CutShort."""
        lost: list[Usage] = []
        for failed in itertools.count(1):
            attempt = self._api.attempt(ask)
            try:
                with closing(self._read(attempt)) as texts:
                    for text in texts:
                        if text and on_text:
                            on_text(text)
            except _ServerFault as fault:
                lost.append(attempt.usage())
                self._wait(ask, failed, fault, lost)
            else:
                return raise_for_stop(self._priced(attempt.turn(), ask, lost))
        raise AssertionError("unreachable")

    def _read(self, attempt: Attempt) -> Generator[str]:
        """Reads a whole answer, and yields its words as they come. Raises _ServerFault for all that a server can do."""
        try:
            for text in attempt.read():
                self._heard = True
                yield text
            attempt.turn()
        except Exception as error:
            fault = attempt.fault_of(error)
            if fault is None:
                raise
            raise _ServerFault(fault, error) from error

    def _wait(self, ask: Ask, failed: int, found: _ServerFault, lost: list[Usage]) -> None:
        """Waits until the request may be sent again. Raises Rejected, TooLong, Unreachable."""
        fault, used = found.fault, sum(lost, Usage())
        if fault.is_lasting:
            raise _with(used, self._rejected(fault)) from found.error
        patience = self._settings.patience
        self._heard = self._heard or fault.status > 0
        tries = patience.tries if self._heard else min(patience.unheard, patience.tries)
        if failed >= tries or fault.requested_pause > patience.most_asked:
            why = (
                f"{failed} times in a row"
                if failed >= tries
                else f"it asks to wait {fault.requested_pause:.0f} s"
            )
            message = f"No answer from {self._api.address}: {fault.words} ({why})."
            raise _with(used, Unreachable(message)) from found.error
        pause = patience.pause(failed, fault.requested_pause, self._chance)
        if self._tell:
            self._tell(Retry(ask, failed, fault.words, pause, used))
        self._pause(pause)

    def _rejected(self, fault: Fault) -> Rejected:
        if fault.status == 413 or any(sign in fault.words for sign in _TOO_LONG):
            return TooLong(f"The conversation is too long for the model: {fault.words}.", fault.status)
        advice = self._api.advice.get(fault.status, "")
        return Rejected(f"{self._api.address} rejects the request: {fault.words}.{advice}", fault.status)

    def _priced(self, turn: Turn, ask: Ask, lost: list[Usage]) -> Turn:
        costs = [self._settings.prices.cost(ask.model, usage) for usage in (turn.usage, *lost)]
        known = [cost for cost in costs if cost is not None]
        cost = sum(known) if len(known) == len(costs) else None
        return replace(turn, cost=cost, lost=sum(lost, Usage()))


_E = TypeVar("_E", bound=ModelError)


def _with(lost: Usage, error: _E) -> _E:
    error.lost = lost
    return error
