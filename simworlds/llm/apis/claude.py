"""Claude, or any server that speaks Anthropic's Messages API. Answers are streamed."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING

import httpx2
from anthropic import AnthropicError, APIStatusError

from simworlds.llm.apis.anthropic_client import Credentials, anthropic_client
from simworlds.llm.apis.attempts import CONNECT_SECONDS, Attempts, Fault, Settings
from simworlds.llm.apis.claude_request import params_of
from simworlds.llm.apis.claude_stream import BrokenStream, LimitedBytes, StreamedAnswer
from simworlds.llm.apis.retries import is_passing, one_line, requested_pause
from simworlds.llm.errors import Rejected

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Generator

    from anthropic import Anthropic

    from simworlds.llm.apis.retries import Retry
    from simworlds.llm.messages import Ask, Turn, Usage

_ADVICE = {
    401: " Check the key (ANTHROPIC_API_KEY).",
    402: " Check the account's credit.",
    403: " Check that the key may use this model.",
    404: " Check the model's name.",
}
_FAULTS = (
    AnthropicError,
    httpx2.HTTPError,
    httpx2.StreamError,
    httpx2.InvalidURL,  # a redirection to nowhere
    json.JSONDecodeError,
    UnicodeDecodeError,
    BrokenStream,
)
_LASTING = (
    "invalid_request_error",
    "authentication_error",
    "billing_error",
    "permission_error",
    "not_found_error",
    "request_too_large",
)


class Claude(Attempts):
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
        """``tell`` is called before every Retry; what it raises ends the call. Raises Rejected without a key.

        The environment's settings are ANTHROPIC_API_KEY (or ANTHROPIC_AUTH_TOKEN) and ANTHROPIC_BASE_URL.
        """
        settings = settings or Settings()
        super().__init__(_MessagesApi(settings, clock), settings, tell, pause=pause, chance=chance)


class _MessagesApi:
    """An Api, see ``attempts``."""

    advice = _ADVICE

    def __init__(self, settings: Settings, clock: Callable[[], float]) -> None:
        self._settings = settings
        self._clock = clock
        self.client = _client(settings)

    @property
    def address(self) -> str:
        return str(self.client.base_url)

    def close(self) -> None:
        self.client.close()

    def attempt(self, ask: Ask) -> _MessagesAttempt:
        return _MessagesAttempt(self.client, ask, self._settings.longest, self._clock)


class _MessagesAttempt:
    """An Attempt, see ``attempts``."""

    def __init__(self, client: Anthropic, ask: Ask, longest: float, clock: Callable[[], float]) -> None:
        self._client, self._ask, self._longest, self._clock = client, ask, longest, clock
        self._answer = StreamedAnswer()

    def read(self) -> Generator[str]:
        with self._client.messages.stream(**params_of(self._ask)) as events:
            yield ""  # the server has answered
            response = events.response
            assert isinstance(response.stream, httpx2.SyncByteStream)
            response.stream = LimitedBytes(response.stream, self._longest, self._clock)
            yield from self._answer.read(events)

    def turn(self) -> Turn:
        return self._answer.turn()

    def usage(self) -> Usage:
        return self._answer.usage()

    def fault_of(self, error: Exception) -> Fault | None:
        if not isinstance(error, _FAULTS):
            return None
        if not isinstance(error, APIStatusError):
            if isinstance(error, BrokenStream):
                return Fault(one_line(f"the answer is incomplete: {error}"))
            # The package hides what the network raised behind its own words.
            cause = (isinstance(error, AnthropicError) and error.__cause__) or error
            return Fault(one_line(f"{type(cause).__name__}: {cause}".rstrip(": ")))
        words = error.api_message or error.message
        if error.response.is_success:  # the server failed after it had begun to answer
            return Fault(
                one_line(f"the server broke off with {error.type}: {words}"),
                is_lasting=error.type in _LASTING,
            )
        status, headers = error.status_code, error.response.headers
        return Fault(
            one_line(f"{status} {words}"), status, not is_passing(status, headers), requested_pause(headers)
        )


def _client(settings: Settings) -> Anthropic:
    """The package's client, without its own retries: it does not report them, nor retry broken streams."""
    if (credentials := Credentials.found(settings.api_key)) is None:
        raise Rejected(
            "There is no key for the model: set the environment variable ANTHROPIC_API_KEY. For a server of your own "
            "(ANTHROPIC_BASE_URL) that checks no key, any text will do."
        )
    timeout = httpx2.Timeout(settings.silence, connect=min(settings.silence, CONNECT_SECONDS))
    return anthropic_client(credentials, base_url=settings.base_url, timeout=timeout, max_retries=0)
