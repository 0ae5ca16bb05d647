"""Anthropic's Message Batches API, with the patience that work of up to a day needs.

Passing faults (no connection, timeouts, 429, 5xx) are waited out: first by the client's own retries, then by
ours. What will not pass (a wrong key, a request that the API rejects) is a SummaryError at once.
"""

from __future__ import annotations

import itertools
import json
import time
from typing import TYPE_CHECKING, TypeVar

import httpx2
from anthropic import (
    AnthropicError,
    APIConnectionError,
    APIStatusError,
    ConflictError,
    InternalServerError,
    NotFoundError,
    RateLimitError,
    RequestTimeoutError,
    omit,
)
from anthropic.types.messages import MessageBatch
from pydantic import BaseModel, ValidationError

from kb_build.errors import SummaryError
from kb_build.summaries.replies import SummaryReply
from simworlds.llm.apis.anthropic_client import anthropic_client
from simworlds.llm.errors import Rejected

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from anthropic.types.message_create_params import MessageCreateParamsNonStreaming
    from anthropic.types.messages.batch_create_params import Request

    from kb_build.summaries.types import ClaudeOptions
    from simworlds.llm.apis.anthropic_client import Credentials

_T = TypeVar("_T")
_CLOCK_SKEW_SECONDS = 3600.0
_READINGS = 3
_NOT_RECEIVED = (429, 503, 529)
_PATIENCE_AT_FIRST = 3
_MAX_PAUSE_SECONDS = 600.0


class _UnusableReplyError(Exception):
    """A reply with a good status that is not what the API promises: a proxy's page, half a body."""


_PASSING = (
    APIConnectionError,
    RateLimitError,
    InternalServerError,
    RequestTimeoutError,
    ConflictError,
    httpx2.TransportError,
    json.JSONDecodeError,
    UnicodeDecodeError,
    _UnusableReplyError,
)


class BatchGoneError(Exception):
    """The API does not know the batch, or no longer has its results."""


class _Error(BaseModel):
    type: str = ""
    message: str = ""


class _ErrorReply(BaseModel):
    error: _Error = _Error()


class ItemResult(BaseModel):
    """What became of one request of a batch. ``type`` is the API's, or ``"malformed"``."""

    type: str
    message: SummaryReply | None = None
    error: _ErrorReply | None = None


class BatchAPI:
    """The calls that summaries need. Each raises SummaryError when the API stays out of reach or says no."""

    def __init__(self, credentials: Credentials, options: ClaudeOptions, tell: Callable[[str], None]) -> None:
        try:
            self._client = anthropic_client(
                credentials,
                base_url=options.base_url,
                timeout=httpx2.Timeout(options.timeout, connect=min(options.timeout, 5.0)),
                max_retries=options.retries,
            )
        except Rejected as error:
            raise SummaryError(str(error)) from error
        self.base_url = str(self._client.base_url)
        self._options = options
        self._tell = tell
        self._answered = False

    def close(self) -> None:
        """Close the connections."""
        self._client.close()

    def count_tokens(self, request: MessageCreateParamsNonStreaming) -> int | None:
        """The input tokens of ``request`` as the API counts them; None when it cannot say just now."""
        try:
            counted = self._client.messages.count_tokens(
                model=request["model"],
                messages=request["messages"],
                system=request.get("system", omit),
                output_config=request.get("output_config", omit),
                thinking=request.get("thinking", omit),
            )
        except _PASSING:
            return None
        except APIStatusError as error:
            raise self._rejected("count the tokens of a page", error) from error
        self._answered = True
        tokens = getattr(counted, "input_tokens", None)
        return tokens if isinstance(tokens, int) else None

    def send(
        self, requests: Sequence[Request], nonce: str, sent: float, known: Collection[str]
    ) -> MessageBatch:
        """Create a batch, once.

        A lost reply may hide a batch that was created and will be paid for, so after one the batch is looked
        for (see :meth:`find`) before it is sent again; the client's own retries would not do that.
        """
        create = self._client.with_options(max_retries=0).messages.batches.create
        for failed in itertools.count(1):
            try:
                return _checked(create(requests=requests))
            except _PASSING as error:
                if not (isinstance(error, APIStatusError) and error.status_code in _NOT_RECEIVED):
                    batch = self.find(nonce, len(requests), sent, known)
                    if batch:
                        return batch
                self._pause_or_give_up("send a batch", failed, error)
            except APIStatusError as error:
                raise self._rejected("send a batch", error) from error
        raise AssertionError("unreachable")

    def find(self, nonce: str, count: int, sent: float, known: Collection[str]) -> MessageBatch | None:
        """The batch that was sent as ``nonce`` and whose id is not known, if the API received it.

        A batch shows what it holds only once it has ended. So every batch of the right size and time that is
        not in ``known`` is waited for, until one has our custom_ids in its results.
        """
        for batch in self._patiently("list the batches", self._recent):
            counts = batch.request_counts
            total = counts.processing + counts.succeeded + counts.errored + counts.canceled + counts.expired
            recent = batch.created_at.timestamp() > sent - _CLOCK_SKEW_SECONDS
            if batch.id in known or total != count or not recent:
                continue
            try:
                ended = self.wait(batch.id)
                if any(custom_id.startswith(nonce) for custom_id in self.results(batch.id, count)):
                    return ended
            except BatchGoneError:
                continue
        return None

    def look(self, batch_id: str) -> MessageBatch:
        """The batch as it is now. Raises BatchGoneError."""
        retrieve = self._client.messages.batches.retrieve
        return self._patiently(f"look at batch {batch_id}", lambda: _checked(retrieve(batch_id)))

    def wait(self, batch_id: str) -> MessageBatch:
        """The batch, once it has ended. Raises BatchGoneError."""
        pause = self._options.poll_seconds
        deadline = time.monotonic() + self._options.max_wait
        while True:
            batch = self.look(batch_id)
            if batch.processing_status == "ended":
                return batch
            if time.monotonic() > deadline:
                raise SummaryError(
                    f"Batch {batch_id} has not ended after {self._options.max_wait / 3600:.1f} hours. It is "
                    "remembered: build again later to pick it up, or cancel it in Anthropic's console."
                )
            time.sleep(pause)
            pause = min(pause * 1.5, self._options.poll_max_seconds)

    def results(self, batch_id: str, count: int) -> dict[str, ItemResult]:
        """What became of the requests of an ended batch, by custom_id. Raises BatchGoneError.

        Lines that cannot be read are asked for again, then left out.
        """
        results: dict[str, ItemResult] = {}
        for _ in range(_READINGS):
            results.update(self._patiently(f"read batch {batch_id}", lambda: self._read(batch_id)))
            if len(results) >= count:
                break
        return results

    def _recent(self) -> list[MessageBatch]:
        try:
            batches = self._client.messages.batches.list(limit=100).data or []
        except AttributeError:  # the client trips over a reply that is no JSON object
            raise _UnusableReplyError("the reply is not a list of message batches") from None
        return [_checked(batch) for batch in batches]

    def _read(self, batch_id: str) -> dict[str, ItemResult]:
        results = self._client.messages.batches.results(batch_id)
        try:
            lines = results.http_response.read().split(b"\n")
        finally:
            results.close()
        return dict(filter(None, map(_result, lines)))

    def _patiently(self, what: str, call: Callable[[], _T]) -> _T:
        for failed in itertools.count(1):
            try:
                reply = call()
            except _PASSING as error:
                self._pause_or_give_up(what, failed, error)
            except NotFoundError as error:
                raise BatchGoneError(str(error)) from error
            except APIStatusError as error:
                raise self._rejected(what, error) from error
            except AnthropicError as error:  # the client's own: an ended batch without results
                raise BatchGoneError(str(error)) from error
            else:
                self._answered = True
                return reply
        raise AssertionError("unreachable")

    def _pause_or_give_up(self, what: str, failed: int, error: Exception) -> None:
        # Where nobody has answered yet, the address or the network is wrong rather than busy.
        self._answered = self._answered or isinstance(error, APIStatusError)
        patience = self._options.patience if self._answered else _PATIENCE_AT_FIRST
        if failed > min(patience, self._options.patience):
            raise SummaryError(
                f"Could not {what} at {self.base_url}: {_in_words(error)} ({failed} times in a row). "
                "Check the network and try again: what was sent is remembered and picked up. Or use "
                "the method 'extractive', which needs no network."
            ) from error
        pause = self._options.poll_seconds * min(failed, 8)
        if isinstance(error, APIStatusError):
            pause = max(pause, _retry_after(error))
        pause = min(pause, _MAX_PAUSE_SECONDS)
        self._tell(f"could not {what} ({_in_words(error)}); trying again in {pause:.0f} s")
        time.sleep(pause)

    def _rejected(self, what: str, error: APIStatusError) -> SummaryError:
        if error.status_code in (401, 403):
            advice = "Check that ANTHROPIC_API_KEY holds a valid key that may use this model."
        elif error.status_code == 402:
            advice = "Check the account's credit."
        else:
            advice = "Check the model's name and the options."
        return SummaryError(
            f"Anthropic's API at {self.base_url} refused to {what}: {_in_words(error)}. {advice} Or use the "
            "method 'extractive', which needs neither key nor network."
        )


def _checked(batch: object) -> MessageBatch:
    """``batch`` if it is one: the client passes on whatever a server with a good status sends."""
    if not isinstance(batch, MessageBatch):
        raise _UnusableReplyError("the reply is not a message batch")
    try:
        return MessageBatch.model_validate(batch.model_dump(warnings=False))
    except ValidationError:
        raise _UnusableReplyError("the reply is not a whole message batch") from None


def _result(line: bytes) -> tuple[str, ItemResult] | None:
    try:
        row = json.loads(line)
    except (ValueError, RecursionError):
        return None
    custom_id = row.get("custom_id") if isinstance(row, dict) else None
    if not isinstance(custom_id, str):
        return None
    try:
        return custom_id, ItemResult.model_validate(row.get("result"))
    except ValidationError:
        return custom_id, ItemResult(type="malformed")


def _retry_after(error: APIStatusError) -> float:
    try:
        return max(0.0, float(error.response.headers.get("retry-after", 0)))
    except ValueError:
        return 0.0


def _in_words(error: Exception) -> str:
    if isinstance(error, APIStatusError):
        return f"{error.status_code} {error.api_message or error.message}"[:300]
    return (str(error) or type(error).__name__)[:300]
