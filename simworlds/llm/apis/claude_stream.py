"""Reads a streamed answer of the Messages API; it counts only when it is whole.

The anthropic package accumulates the events, but leniently: it makes a message of a stream that ends early, of blocks
that were never closed, and of half a tool call. Here these are errors. Kinds of events, blocks and deltas that are not
known yet are ignored or kept as they came.
"""

from __future__ import annotations

from collections import defaultdict
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import httpx2
from pydantic import BaseModel, NonNegativeInt

from simworlds.llm import tokens
from simworlds.llm.apis.tool_input import read_input
from simworlds.llm.messages import Block, Kept, Text, ToolUse, Turn, Usage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from anthropic.lib.streaming import MessageStream, ParsedMessageStreamEvent

_LARGEST = 50_000_000  # bytes of one answer
_CUT = ("max_tokens", "model_context_window_exceeded", "refusal")
_DELTAS = {"text_delta": "text", "thinking_delta": "thinking", "input_json_delta": "partial_json"}
_JUNK = (ArithmeticError, AssertionError, AttributeError, LookupError, RuntimeError, TypeError, ValueError)
"""What the package raises for invalid events: it does not validate them."""


class BrokenStream(Exception):  # noqa: N818 - reads as the state it names
    """The stream did not give a whole answer."""


class LimitedBytes(httpx2.SyncByteStream):
    """The bytes of an answer, for a limited time and up to a limited size. Raises BrokenStream.

    Only here are all bytes seen: the package drops pings, so that a server could keep a client waiting forever.
    """

    def __init__(self, source: httpx2.SyncByteStream, seconds: float, clock: Callable[[], float]) -> None:
        self._source, self._seconds, self._clock = source, seconds, clock
        self._end = clock() + seconds

    def __iter__(self) -> Iterator[bytes]:
        """The chunks of the source."""
        size = 0
        for chunk in self._source:
            yield chunk
            size += len(chunk)
            if self._clock() > self._end:
                raise BrokenStream(f"it takes more than {self._seconds:.0f} s")
            if size > _LARGEST:
                raise BrokenStream(f"it has more than {_LARGEST} bytes")

    def close(self) -> None:
        """Closes the source."""
        self._source.close()


class _Counts(BaseModel, from_attributes=True):
    input_tokens: NonNegativeInt | None = None
    output_tokens: NonNegativeInt | None = None
    cache_creation_input_tokens: NonNegativeInt | None = None
    cache_read_input_tokens: NonNegativeInt | None = None


class _StopDetails(BaseModel, from_attributes=True):
    category: str | None = None
    explanation: str | None = None


class _Checked(BaseModel, from_attributes=True):
    """What is read of the package's message, which it does not check."""

    content: list[Any]
    model: str
    stop_reason: str | None = None
    stop_details: _StopDetails | None = None
    usage: _Counts


class StreamedAnswer:
    """A message that grows while ``read`` goes on."""

    def __init__(self) -> None:
        self._message: _Checked | None = None
        self._pieces: defaultdict[int, list[str]] = defaultdict(list)  # by block; of tool calls, their JSON
        self._open: int | None = None  # the block that is being sent
        self._is_whole = False

    def read(self, stream: MessageStream[None]) -> Iterator[str]:
        """Reads until the message is whole, and yields what of it people may read: texts and thinking.

        Raises BrokenStream, and what the package raises for errors of the server and the network.
        """
        while not self._is_whole:
            try:
                event = next(stream, None)
                if event is None:
                    raise BrokenStream("the stream ended in the middle")
                yield self._take(event, stream)
            except _JUNK as error:
                raise BrokenStream(f"an invalid event ({type(error).__name__}: {error})") from error

    def turn(self) -> Turn:
        """The whole answer, without its cost. Raises BrokenStream."""
        message = self._message
        if not self._is_whole or message is None or message.stop_reason is None:
            raise BrokenStream("the stream ended in the middle")
        last = len(message.content) - 1 if message.stop_reason in _CUT else None
        blocks = [
            self._block(place, block, is_cut=place == last) for place, block in enumerate(message.content)
        ]
        details = message.stop_details or _StopDetails()
        return Turn(
            content=tuple(block for block in blocks if block is not None),
            stop_reason=message.stop_reason,
            usage=self.usage(),
            model=message.model,
            stop_details=": ".join(filter(None, (details.category, details.explanation))),
            live=True,
        )

    def usage(self) -> Usage:
        """The tokens so far; of an answer that is not whole, its output by estimate."""
        if self._message is None:
            return Usage()
        counts = self._message.usage
        output = counts.output_tokens or 0
        if not self._is_whole:
            output = max(output, sum(tokens.of_text("".join(pieces)) for pieces in self._pieces.values()))
        return Usage(
            counts.input_tokens or 0,
            output,
            counts.cache_read_input_tokens or 0,
            counts.cache_creation_input_tokens or 0,
        )

    def _take(self, event: ParsedMessageStreamEvent[None], stream: MessageStream[None]) -> str:
        """Checks that an event comes in the API's order; what of it people may read. Raises BrokenStream."""
        text, in_order = "", True
        match event.type:
            case "message_start":
                in_order = self._message is None
                self._message = _Checked.model_validate(stream.current_message_snapshot)
            case "content_block_start":
                in_order = self._open is None
                self._open = event.index
                in_order &= event.index == len(stream.current_message_snapshot.content) - 1
            case "content_block_delta":
                in_order = event.index == self._open
                kind = event.delta.type
                piece = str(getattr(event.delta, _DELTAS.get(kind, ""), ""))
                self._pieces[event.index].append(piece)
                text = "" if kind == "input_json_delta" else piece
            case "content_block_stop":
                in_order = event.index == self._open
                self._open = None
            case "message_delta" | "message_stop":
                self._message = _Checked.model_validate(stream.current_message_snapshot)
                if event.type == "message_stop":
                    self._is_whole = in_order = self._open is None and self._message.stop_reason is not None
            case _:
                pass
        if not in_order:
            raise BrokenStream(f"events out of order ({event.type})")
        return text

    def _block(self, place: int, block: Any, *, is_cut: bool) -> Block | None:
        if block.type == "text":
            return Text(block.text) if block.text else None
        if block.type != "tool_use":
            return Kept(block.to_dict(warnings=False))
        text = "".join(self._pieces[place])
        with suppress(ValueError):
            arguments = read_input(text)
            if isinstance(block.name, str) and isinstance(block.id, str):
                return ToolUse(block.id, block.name, arguments)
        if is_cut:
            return None
        raise BrokenStream(f"an invalid tool call: {text[:80]!r}")
