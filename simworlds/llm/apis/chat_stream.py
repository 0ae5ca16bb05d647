"""Reads a streamed chat completion; it counts only when it is whole.

Servers differ in how they stream tool calls: some leave out indexes or give the same to all, send a call's id again
with each piece or an empty one, or the arguments as an object. A piece belongs to the call at its index, unless its id
is that of another; without an index, to the call of its id, or else to the last one.
"""

from __future__ import annotations

import uuid
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, Field, NonNegativeInt, ValidationError

from simworlds.llm import tokens
from simworlds.llm.apis.claude_stream import BrokenStream
from simworlds.llm.apis.tool_input import read_input
from simworlds.llm.messages import Block, Text, ToolUse, Turn, Usage
from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_STOPS = {"length": "max_tokens", "content_filter": "refusal"}


class _Function(BaseModel):
    name: str | None = None
    arguments: str | dict[str, Any] | None = None


class _CallPiece(BaseModel):
    index: int | None = None
    id: str | None = None
    function: _Function = Field(default_factory=_Function)


class _Delta(BaseModel):
    content: str | None = None
    refusal: str | None = None
    reasoning: str | None = None
    reasoning_content: str | None = None
    tool_calls: tuple[_CallPiece, ...] | None = None


class _Choice(BaseModel):
    finish_reason: str | None = None
    delta: _Delta = Field(default_factory=_Delta)


class _Cached(BaseModel):
    cached_tokens: NonNegativeInt | None = None


class _Usage(BaseModel):
    prompt_tokens: NonNegativeInt = 0
    completion_tokens: NonNegativeInt = 0
    prompt_tokens_details: _Cached | None = None


class _Chunk(BaseModel):
    model: str = ""
    choices: tuple[_Choice, ...] = ()
    usage: _Usage | None = None


@dataclass(slots=True)
class _Call:
    index: int | None
    id: str
    name: str = ""
    pieces: list[str] = field(default_factory=list[str])
    given: dict[str, Any] | None = None

    def add(self, piece: _CallPiece) -> None:
        self.name = self.name or piece.function.name or ""
        given = piece.function.arguments
        if isinstance(given, dict):
            self.given = given
        else:
            self.pieces.append(given or "")


class ChatAnswer:
    """A completion that grows while ``read`` goes on."""

    def __init__(self) -> None:
        self._model = ""
        self._words: list[str] = []
        self._thinking: list[str] = []
        self._refusal: list[str] = []
        self._calls: list[_Call] = []
        self._finished = ""
        self._usage: _Usage | None = None

    def read(self, chunks: Iterable[object]) -> Iterator[str]:
        """Reads decoded chunks to their end, and yields what people may read of them. Raises BrokenStream."""
        for chunk in chunks:
            try:
                valid = _Chunk.model_validate(chunk)
            except ValidationError as error:
                fault = first_fault(error, whole="the whole")
                raise BrokenStream(f"an invalid piece ({fault})") from error
            yield self._take(valid)

    def turn(self) -> Turn:
        """The whole answer, without its cost. Raises BrokenStream."""
        if not self._finished:
            raise BrokenStream("the stream ended in the middle")
        stop = _STOPS.get(self._finished, "end_turn")
        declined = "".join(self._refusal)
        if declined:
            stop = "refusal"
        last = len(self._calls) - 1 if stop != "end_turn" else None
        taken: set[str] = set()
        calls = [_tool_use(call, taken, is_cut=place == last) for place, call in enumerate(self._calls)]
        words = "".join(self._words)
        content: list[Block] = [Text(words)] if words else []
        content += [call for call in calls if call is not None]
        if stop == "end_turn" and self._calls:
            stop = "tool_use"
        return Turn(
            content=tuple(content),
            stop_reason=stop,
            usage=self.usage(),
            model=self._model,
            stop_details=declined,
            live=True,
        )

    def usage(self) -> Usage:
        """The tokens so far; its output by estimate where the server does not count."""
        counted = self._usage
        if counted is None:
            pieces = [
                *self._words,
                *self._thinking,
                *(piece for call in self._calls for piece in call.pieces),
            ]
            return Usage(output=tokens.of_text("".join(pieces))) if pieces else Usage()
        details = counted.prompt_tokens_details
        cached = min((details.cached_tokens if details else None) or 0, counted.prompt_tokens)
        return Usage(counted.prompt_tokens - cached, counted.completion_tokens, cached)

    def _take(self, chunk: _Chunk) -> str:
        self._model = self._model or chunk.model
        self._usage = chunk.usage or self._usage
        if not chunk.choices:
            return ""
        choice = chunk.choices[0]
        self._finished = choice.finish_reason or self._finished
        delta = choice.delta
        for piece in delta.tool_calls or ():
            self._call_of(piece).add(piece)
        thinking = delta.reasoning_content or delta.reasoning or ""
        self._words.append(delta.content or "")
        self._thinking.append(thinking)
        self._refusal.append(delta.refusal or "")
        return thinking + (delta.content or "")

    def _call_of(self, piece: _CallPiece) -> _Call:
        at = [call for call in self._calls if piece.index is None or call.index == piece.index]
        if piece.id:
            at = [call for call in at if call.id == piece.id]
        elif piece.index is None and piece.function.name:
            at = []  # a name without id and index begins a call
        if not at:
            self._calls.append(_Call(piece.index, piece.id or ""))
            return self._calls[-1]
        return at[-1]


def _tool_use(call: _Call, taken: set[str], *, is_cut: bool) -> ToolUse | None:
    """The call; None for one that was cut off. Its id is one that is not ``taken`` yet."""
    # Nine letters and digits, which the strictest servers want.
    identifier = call.id if call.id and call.id not in taken else uuid.uuid4().hex[:9]
    taken.add(identifier)
    try:
        arguments = read_input("".join(call.pieces) if call.given is None else call.given)
    except ValueError as error:
        return None if is_cut else ToolUse(identifier, call.name, {}, str(error))
    return ToolUse(identifier, call.name, arguments)
