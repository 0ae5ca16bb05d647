"""Reads a streamed answer of the Messages API, byte by byte, and believes nothing of it until it is whole.

The API may add kinds of events, blocks and deltas: those that are not known here are passed over or kept as they came.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, NonNegativeInt, ValidationError
from pydantic_core import from_json

from simworlds.llm import tokens
from simworlds.llm.messages import Block, Kept, Text, ToolUse, Turn, Usage

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_LARGEST = 16_000_000  # bytes of one event
_CUT = ("max_tokens", "model_context_window_exceeded", "refusal")


class Broken(Exception):  # noqa: N818 - reads as the state it names
    """What comes is not a whole answer, or none at all."""


class Failed(Exception):  # noqa: N818
    """The server says in the middle of a stream that it failed. ``kind`` is the API's name for it."""

    def __init__(self, kind: str, message: str) -> None:
        self.kind = kind
        super().__init__(message)


class _Usage(BaseModel):
    input_tokens: NonNegativeInt | None = None
    output_tokens: NonNegativeInt | None = None
    cache_creation_input_tokens: NonNegativeInt | None = None
    cache_read_input_tokens: NonNegativeInt | None = None


class _Message(BaseModel):
    model: str
    usage: _Usage


class _Start(BaseModel):
    message: _Message


class _Typed(BaseModel, extra="allow"):
    type: str


class _BlockStart(BaseModel):
    index: int
    content_block: _Typed


class _Delta(BaseModel):
    type: str
    text: str = ""
    thinking: str = ""
    signature: str = ""
    partial_json: str = ""


class _BlockDelta(BaseModel):
    index: int
    delta: _Delta


class _BlockStop(BaseModel):
    index: int


class _StopDetails(BaseModel):
    category: str | None = None
    explanation: str | None = None


class _Stop(BaseModel):
    stop_reason: str | None = None
    stop_details: _StopDetails | None = None


class _MessageDelta(BaseModel):
    delta: _Stop
    usage: _Usage = _Usage()


class _MessageStop(BaseModel):
    pass


class _Fault(BaseModel):
    type: str = "api_error"
    message: str = ""


class _Error(BaseModel):
    error: _Fault


_EVENTS: dict[str, type[BaseModel]] = {
    "message_start": _Start,
    "content_block_start": _BlockStart,
    "content_block_delta": _BlockDelta,
    "content_block_stop": _BlockStop,
    "message_delta": _MessageDelta,
    "message_stop": _MessageStop,
    "error": _Error,
}


def events(chunks: Iterable[bytes]) -> Iterator[BaseModel]:
    """The events in ``chunks``, those of unknown kinds left out. Raises Broken."""
    for data in _payloads(chunks):
        try:
            kind = _Typed.model_validate_json(data).type
            known = _EVENTS.get(kind)
            if known:
                yield known.model_validate_json(data)
        except ValidationError as error:
            fault = error.errors(include_url=False, include_context=False)[0]
            raise Broken(f"an event that is none ({fault['msg']}): {data[:80]!r}") from None


def _payloads(chunks: Iterable[bytes]) -> Iterator[bytes]:
    data: list[bytes] = []
    for line in _lines(chunks):
        if not line and data:
            yield b"\n".join(data)
            data = []
        elif line.startswith(b"data:"):
            data.append(line[5:].lstrip(b" "))


def _lines(chunks: Iterable[bytes]) -> Iterator[bytes]:
    rest = b""
    for chunk in chunks:
        *lines, rest = (rest + chunk).split(b"\n")
        if len(rest) > _LARGEST:
            raise Broken("an event without end")
        for line in lines:
            yield line.removesuffix(b"\r")


@dataclass(slots=True)
class _Growing:
    """A block as far as it has come."""

    start: dict[str, Any]
    pieces: list[str] = field(default_factory=list[str])
    signature: str = ""

    @property
    def kind(self) -> str:
        return self.start["type"]


class Answer:
    """A message that grows event by event."""

    def __init__(self) -> None:
        self._model = ""
        self._usage: _Usage | None = None
        self._blocks: list[_Growing] = []
        self._is_open = False
        self._stop = _Stop()
        self.done = False

    def take(self, event: BaseModel) -> str:
        """Adds an event; what of it is for people to read. Raises Broken, Failed."""
        if isinstance(event, _Error):
            raise Failed(event.error.type, event.error.message)
        if (self._usage is None) != isinstance(event, _Start) or self.done:
            raise Broken(f"events out of order ({_name_of(event)})")
        match event:
            case _Start():
                self._model, self._usage = event.message.model, event.message.usage
            case _BlockStart():
                self._expect(event.index == len(self._blocks) and not self._is_open, event)
                self._blocks.append(_Growing(event.content_block.model_dump()))
                self._is_open = True
            case _BlockDelta():
                self._expect(event.index == len(self._blocks) - 1 and self._is_open, event)
                return self._grow(event.delta)
            case _BlockStop():
                self._expect(event.index == len(self._blocks) - 1 and self._is_open, event)
                self._is_open = False
            case _MessageDelta():
                self._stop = event.delta
                self._count(event.usage)
            case _:
                self._expect(self._stop.stop_reason is not None and not self._is_open, event)
                self.done = True
        return ""

    def turn(self) -> Turn:
        """The whole answer, without its cost. Raises Broken."""
        reason = self._stop.stop_reason
        if not self.done or reason is None:
            raise Broken("the stream ended in the middle")
        blocks = [self._block(block, reason) for block in self._blocks]
        details = self._stop.stop_details
        said = [details.category, details.explanation] if details else []
        return Turn(
            content=tuple(block for block in blocks if block is not None),
            stop_reason=reason,
            usage=self.usage(),
            model=self._model,
            stop_details=": ".join(part for part in said if part),
            live=True,
        )

    def usage(self) -> Usage:
        """The tokens so far; of an answer that is not whole, its output by estimate."""
        if self._usage is None:
            return Usage()
        output = self._usage.output_tokens or 0
        if not self.done:
            output = max(output, sum(tokens.of_text("".join(block.pieces)) for block in self._blocks))
        return Usage(
            self._usage.input_tokens or 0,
            output,
            self._usage.cache_read_input_tokens or 0,
            self._usage.cache_creation_input_tokens or 0,
        )

    def _expect(self, holds: bool, event: BaseModel) -> None:
        if not holds:
            raise Broken(f"events out of order ({_name_of(event)})")

    def _grow(self, delta: _Delta) -> str:
        block = self._blocks[-1]
        if delta.type == "signature_delta":
            block.signature = delta.signature
            return ""
        if delta.type == "input_json_delta":
            block.pieces.append(delta.partial_json)
            return ""
        shown = {"text_delta": delta.text, "thinking_delta": delta.thinking}.get(delta.type, "")
        block.pieces.append(shown)
        return shown

    def _count(self, later: _Usage) -> None:
        """Counts are totals; one that is missing leaves the earlier standing."""
        assert self._usage is not None
        self._usage = self._usage.model_copy(update=later.model_dump(exclude_none=True))

    def _block(self, block: _Growing, reason: str) -> Block | None:
        grown = "".join(block.pieces)
        if block.kind == "text":
            text = str(block.start.get("text", "")) + grown
            return Text(text) if text else None
        if block.kind == "thinking":
            signature = block.signature or block.start.get("signature", "")
            return Kept(
                {
                    **block.start,
                    "thinking": str(block.start.get("thinking", "")) + grown,
                    "signature": signature,
                }
            )
        if block.kind != "tool_use":
            return Kept(block.start)
        try:
            given = from_json(grown or "{}", allow_inf_nan=False)
        except ValueError:
            given = None
        name, call = block.start.get("name"), block.start.get("id")
        if isinstance(given, dict) and isinstance(name, str) and isinstance(call, str):
            return ToolUse(call, name, given)
        if reason in _CUT and block is self._blocks[-1]:
            return None  # unfinished where the answer ends
        raise Broken(f"a tool call that is none: {grown[:80]!r}")


def _name_of(event: BaseModel) -> str:
    return next((name for name, known in _EVENTS.items() if isinstance(event, known)), "?")
