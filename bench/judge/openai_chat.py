"""OpenAI's models, or another server with their chat completions API, with structured outputs.

It uses chat completions, not responses, since far more servers offer them. The openai package retries passing errors;
replies are validated. The one tool of an Ask is the schema of its answer, which the API enforces.
"""

from __future__ import annotations

import base64
import os
from typing import TYPE_CHECKING, Any, cast

import httpx2
from pydantic import BaseModel, NonNegativeInt, ValidationError

from bench.judge.errors import NO_OPENAI_PACKAGE, NotJudged
from simworlds.llm.errors import Rejected, TooLong, Unreachable, raise_for_stop
from simworlds.llm.messages import Picture, Text, Turn, Usage
from simworlds.llm.request import clean

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from openai.types.chat import ChatCompletionMessageParam
    from openai.types.shared_params import ResponseFormatJSONSchema

    from simworlds.llm.messages import Ask, Block, Message
    from simworlds.llm.prices import Prices

RETRIES = 7
_SECONDS = 600.0
_CONNECT_SECONDS = 10.0
_PASSING = (408, 409, 429)
_STOPS = {"stop": "end_turn", "length": "max_tokens", "content_filter": "refusal"}
_ADVICE = {
    401: " Check the key (OPENAI_API_KEY).",
    403: " Check that the key may use this model.",
    404: " Check the model's name.",
}
_EMPTY = "(no words)"


class _Cached(BaseModel):
    cached_tokens: NonNegativeInt | None = None


class _Usage(BaseModel):
    prompt_tokens: NonNegativeInt = 0
    completion_tokens: NonNegativeInt = 0
    prompt_tokens_details: _Cached | None = None


class _ReplyMessage(BaseModel):
    content: str | None = None
    refusal: str | None = None


class _Choice(BaseModel):
    finish_reason: str | None = None
    message: _ReplyMessage


class _Completion(BaseModel):
    model: str = ""
    choices: tuple[_Choice, ...]
    usage: _Usage | None = None


class OpenAIChat:
    """A Model (``simworlds.llm.messages``) for Asks of texts and pictures."""

    def __init__(self, base_url: str | None, prices: Prices, *, retries: int = RETRIES) -> None:
        """Raises Rejected without a key, NotJudged without the package."""
        try:
            import openai  # noqa: PLC0415 - an optional extra
        except ImportError as error:
            raise NotJudged("not set up", NO_OPENAI_PACKAGE) from error
        self._package: ModuleType = openai
        self._prices = prices
        key = os.environ.get("OPENAI_API_KEY", "").strip()
        if not key:
            raise Rejected(
                "There is no API key: set OPENAI_API_KEY (to any word if the server needs no key)."
            )
        if not key.isascii() or not key.isprintable():
            raise Rejected("OPENAI_API_KEY has characters that are not allowed in a key. Copy the key again.")
        timeout = openai.Timeout(_SECONDS, connect=_CONNECT_SECONDS)
        try:
            self._client = openai.OpenAI(api_key=key, base_url=base_url, timeout=timeout, max_retries=retries)
        except (httpx2.InvalidURL, openai.OpenAIError, ValueError, TypeError) as error:
            raise Rejected(
                f"The address of the model (OPENAI_BASE_URL) or of a proxy is invalid: {error}."
            ) from error
        address = self._client.base_url
        if address.scheme not in ("http", "https") or not address.host:
            raise Rejected(f"The address of the model (OPENAI_BASE_URL) is not an HTTP URL: {address}.")

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn, see Model. Raises Rejected, TooLong, Unreachable, Declined, CutShort."""
        del on_text  # answers come in one piece
        package = self._package
        try:
            reply = self._client.chat.completions.with_raw_response.create(
                model=ask.model,
                messages=_messages(ask),
                response_format=_format(ask),
                max_completion_tokens=ask.max_tokens,
            )
            completion = _Completion.model_validate_json(reply.content)
        except package.APIStatusError as error:
            raise self._error_of(error.status_code, error.message) from error
        except (package.OpenAIError, httpx2.HTTPError, httpx2.InvalidURL) as error:
            cause = error.__cause__ or error
            words = f"{type(cause).__name__}: {cause}".rstrip(": ")
            raise Unreachable(f"No answer from {self._client.base_url}: {words}.") from error
        except ValidationError as error:
            fault = error.errors(include_url=False)[0]
            where = ".".join(map(str, fault["loc"])) or "the whole"
            raise Unreachable(
                f"The reply of {self._client.base_url} is not a valid completion ({where}: {fault['msg']})."
            ) from error
        return raise_for_stop(self._turn(ask, completion))

    def _error_of(self, status: int, message: str) -> Rejected | Unreachable:
        words = f"{status} {' '.join(message.split())}"[:300]
        if status in _PASSING or status >= 500:
            return Unreachable(f"No answer from {self._client.base_url}: {words}.")
        kind = TooLong if status == 413 or "context_length_exceeded" in message else Rejected
        advice = _ADVICE.get(status, "")
        return kind(f"{self._client.base_url} rejects the request: {words}.{advice}", status)

    def _turn(self, ask: Ask, completion: _Completion) -> Turn:
        if not completion.choices:
            raise Unreachable(f"The reply of {self._client.base_url} has no choices.")
        choice = completion.choices[0]
        counted = completion.usage or _Usage()
        details = counted.prompt_tokens_details
        cached = min((details.cached_tokens if details else None) or 0, counted.prompt_tokens)
        usage = Usage(counted.prompt_tokens - cached, counted.completion_tokens, cached)
        declined = choice.message.refusal or ""
        return Turn(
            content=(Text(choice.message.content),) if choice.message.content else (),
            stop_reason="refusal" if declined else _STOPS.get(choice.finish_reason or "", "end_turn"),
            usage=usage,
            model=completion.model or ask.model,
            cost=self._prices.cost(ask.model, usage) if completion.usage else None,
            stop_details=declined,
            live=True,
        )


def _messages(ask: Ask) -> list[ChatCompletionMessageParam]:
    system = {"role": "system", "content": clean("\n\n".join(ask.system))}
    return cast("list[ChatCompletionMessageParam]", [system, *map(_message, ask.messages)])


def _message(message: Message) -> dict[str, Any]:
    if message.role == "assistant":
        words = "\n".join(block.text for block in message.content if isinstance(block, Text))
        return {"role": "assistant", "content": clean(words) or _EMPTY}
    return {"role": "user", "content": [_part(block) for block in message.content]}


def _part(block: Block) -> dict[str, Any]:
    if isinstance(block, Picture):
        data = base64.b64encode(block.data).decode()
        address = {"url": f"data:{block.media_type};base64,{data}", "detail": "high"}
        return {"type": "image_url", "image_url": address}
    assert isinstance(block, Text)
    return {"type": "text", "text": clean(block.text) or _EMPTY}


def _format(ask: Ask) -> ResponseFormatJSONSchema:
    (tool,) = ask.tools
    schema = {"name": tool.name, "description": tool.description, "schema": tool.schema, "strict": True}
    return cast("ResponseFormatJSONSchema", {"type": "json_schema", "json_schema": schema})
