"""OpenAI's models, or any server that speaks its chat completions API: Ollama, vLLM, llama.cpp, LM Studio.

It uses chat completions, not responses, since far more servers offer them. Answers are streamed. ``openai`` is an
optional package: it is loaded when a model is made.
"""

from __future__ import annotations

import json
import os
import time
from typing import TYPE_CHECKING, Any

import httpx2

from simworlds.llm.apis.attempts import CONNECT_SECONDS, Attempts, Fault, Settings
from simworlds.llm.apis.chat_request import chat_params_of
from simworlds.llm.apis.chat_stream import ChatAnswer
from simworlds.llm.apis.claude_stream import BrokenStream, LimitedBytes
from simworlds.llm.apis.retries import is_passing, one_line, requested_pause
from simworlds.llm.errors import Rejected

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Generator
    from types import ModuleType

    from simworlds.llm.apis.retries import Retry
    from simworlds.llm.messages import Ask, Turn, Usage

NO_PACKAGE = "The openai package is not installed. Install it with: pip install 'simworlds[openai]'"
_ADVICE = {
    401: " Check the key (OPENAI_API_KEY).",
    402: " Check the account's credit.",
    403: " Check that the key may use this model.",
    404: " Check the model's name, and that the address (OPENAI_BASE_URL) ends in /v1.",
}
# What the limit on an answer is called: some servers know the older name alone.
_NEWER, _OLDER = "max_completion_tokens", "max_tokens"
_NO_KEY = "none"  # for servers that need none: the package insists on a word


class NoPackage(Rejected):
    """The package that speaks the API is not installed."""


class OpenAIChat(Attempts):
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
        """``tell`` is called before every Retry; what it raises ends the call.

        The environment's settings are OPENAI_API_KEY and OPENAI_BASE_URL; with an address of one's own, a key may be
        left out. Raises Rejected without a key, NoPackage without the package.
        """
        settings = settings or Settings()
        super().__init__(_ChatApi(settings, clock), settings, tell, pause=pause, chance=chance)


class _ChatApi:
    """An Api, see ``attempts``."""

    advice = _ADVICE

    def __init__(self, settings: Settings, clock: Callable[[], float]) -> None:
        self.package = _package()
        self.longest = settings.longest
        self.clock = clock
        self.client = _client(self.package, settings)
        self.limit = _NEWER

    @property
    def address(self) -> str:
        return str(self.client.base_url)

    def close(self) -> None:
        self.client.close()

    def attempt(self, ask: Ask) -> _ChatAttempt:
        return _ChatAttempt(self, chat_params_of(ask) | {self.limit: ask.max_tokens})


class _ChatAttempt:
    """An Attempt, see ``attempts``."""

    def __init__(self, api: _ChatApi, params: dict[str, Any]) -> None:
        self._api, self._params = api, params
        self._answer = ChatAnswer()

    def read(self) -> Generator[str]:
        with self._api.client.chat.completions.create(**self._params) as stream:
            yield ""  # the server has answered
            response = stream.response
            response.stream = LimitedBytes(response.stream, self._api.longest, self._api.clock)
            chunks = (chunk.to_dict(warnings=False) for chunk in stream)
            yield from self._answer.read(chunks)

    def turn(self) -> Turn:
        return self._answer.turn()

    def usage(self) -> Usage:
        return self._answer.usage()

    def fault_of(self, error: Exception) -> Fault | None:
        package = self._api.package
        known = (package.OpenAIError, httpx2.HTTPError, httpx2.StreamError, httpx2.InvalidURL)
        if isinstance(error, BrokenStream):
            return Fault(one_line(f"the answer is incomplete: {error}"))
        if isinstance(error, (json.JSONDecodeError, UnicodeDecodeError)):
            return Fault(one_line(f"the answer is incomplete: it is not valid JSON ({error})"))
        if not isinstance(error, known):
            return None
        if not isinstance(error, package.APIStatusError):
            cause = error.__cause__ or error
            return Fault(one_line(f"{type(cause).__name__}: {cause}".rstrip(": ")))
        reply: Any = error
        status, headers = reply.status_code, reply.response.headers
        words = one_line(f"{status} {reply.message}")
        lasting = not is_passing(status, headers)
        if status in (400, 422) and _NEWER in self._params and _NEWER in words:
            self._api.limit, lasting = _OLDER, False
        return Fault(words, status, lasting, requested_pause(headers))


def _package() -> ModuleType:
    try:
        import openai  # noqa: PLC0415 - an optional extra
    except ImportError as error:
        raise NoPackage(NO_PACKAGE) from error
    return openai


def _client(package: ModuleType, settings: Settings) -> Any:
    """The package's client, without its own retries."""
    address = settings.base_url or os.environ.get("OPENAI_BASE_URL", "").strip() or None
    key = (settings.api_key or os.environ.get("OPENAI_API_KEY") or "").strip() or (_NO_KEY if address else "")
    if not key:
        raise Rejected(
            "There is no key for the model: set OPENAI_API_KEY, or OPENAI_BASE_URL for a server that needs none "
            "(Ollama's is http://localhost:11434/v1)."
        )
    if not key.isascii() or not key.isprintable():
        raise Rejected("OPENAI_API_KEY contains characters that are not allowed in keys. Copy the key again.")
    timeout = httpx2.Timeout(settings.silence, connect=min(settings.silence, CONNECT_SECONDS))
    try:
        client = package.OpenAI(api_key=key, base_url=address, timeout=timeout, max_retries=0)
    except (httpx2.InvalidURL, package.OpenAIError, ValueError, TypeError) as error:
        raise Rejected(
            f"The address of the model (OPENAI_BASE_URL) or of a proxy is invalid: {error}."
        ) from error
    if client.base_url.scheme not in ("http", "https") or not client.base_url.host:
        raise Rejected(f"The address of the model (OPENAI_BASE_URL) is not an HTTP URL: {client.base_url}.")
    return client
