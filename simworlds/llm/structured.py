"""Answers that are data: JSON that fits a schema, however the model wraps it.

The JSON may stand bare, in a fence, or among prose; it has to be JSON (no comments, no NaN, no name twice) and to fit
the schema without being bent. What does not is sent back with what is wrong, a few times.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar

from pydantic import BaseModel, ValidationError

from simworlds.llm.errors import CutShort, Misfit
from simworlds.llm.messages import Text, ToolResult, user

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from simworlds.llm.messages import Ask, Message, Model, Turn

T = TypeVar("T")
M = TypeVar("M", bound=BaseModel)
Reader: TypeAlias = "Callable[[Any], tuple[T | None, Sequence[object]]]"
"""Takes decoded JSON and gives what it stands for, or None and what is wrong with it, as sentences."""

_FENCE = re.compile(r"^[ \t]*(`{3,}|~{3,})[ \t]*(?:json\w*)?[ \t]*\n(.*?)^[ \t]*\1", re.MULTILINE | re.DOTALL)
_BEGIN = re.compile(r"[{\[]")
_MOST_PROBLEMS = 20
_LONGEST_VALUE = 80
_NONE = "There is no JSON in the answer."
_LATER = "Not now: the answer has to be the JSON that is asked for, without calls."


@dataclass(frozen=True, slots=True)
class Found(Generic[T]):
    """What the model gave, the turn that it came in, and how many turns it took."""

    value: T
    turn: Turn
    tries: int


def ask_for(
    model: Model,
    ask: Ask,
    reader: Reader[T],
    *,
    tries: int = 3,
    on_text: Callable[[str], object] | None = None,
) -> Found[T]:
    """Asks until the answer is what ``reader`` takes, at most ``tries`` times.

    Raises Misfit (or CutShort) for the last answer that was not, and what the model raises.
    """
    messages = ask.messages
    for left in reversed(range(tries)):
        try:
            turn = model.answer(replace(ask, messages=messages), on_text)
        except CutShort as cut:
            if not left:
                raise
            # Its beginning would only be read again.
            shorter = f"Your answer was cut off after {cut.turn.usage.output} tokens. Give it again, shorter."
            messages = (*messages, user(shorter))
            continue
        try:
            return Found(read(turn.text, reader), turn, tries - left)
        except Misfit as misfit:
            if not left:
                raise
            messages = (*messages, turn.message(), complaint(turn, misfit))
    raise ValueError(f"{tries} tries are none.")


def fits(shape: type[M]) -> Reader[M]:
    """A reader of JSON that fits a pydantic model, whose values have the very types of the schema."""

    def reader(data: Any) -> tuple[M | None, list[str]]:
        try:
            return shape.model_validate_json(json.dumps(data), strict=True), []
        except ValidationError as error:
            return None, [
                f"{_place(fault['loc'])}: {fault['msg']}{_given(fault)}."
                for fault in error.errors(include_url=False, include_context=False)
            ]

    return reader


def read(text: str, reader: Reader[T]) -> T:
    """What the JSON in ``text`` stands for; of several, the last that fits. Raises Misfit."""
    fitting: list[T] = []
    problems: list[str] = []
    for data, wrong in _values(text):
        value, faults = (None, [wrong]) if wrong else reader(data)
        if value is not None and not faults:
            fitting.append(value)
        elif not problems:
            problems = [str(fault) for fault in faults]
    if fitting:
        return fitting[-1]
    if len(problems) > _MOST_PROBLEMS:
        problems = [*problems[:_MOST_PROBLEMS], f"… and {len(problems) - _MOST_PROBLEMS} more."]
    raise Misfit(problems or [_NONE], text)


def complaint(turn: Turn, misfit: Misfit) -> Message:
    """What a model is told of a ``turn`` that is not what was asked for."""
    listed = "\n".join(f"- {problem}" for problem in misfit.problems)
    words = f"Your answer is not the JSON that is asked for:\n{listed}\nGive the whole JSON again, corrected."
    refused = [ToolResult(call.id, (Text(_LATER),), failed=True) for call in turn.calls]
    return user(*refused, words)


def _values(text: str) -> Iterator[tuple[Any, str]]:
    """The JSON in a text, decoded, each with what is wrong with it ("" for nothing).

    A text that is JSON holds just that; one with fences of JSON, those; any other, what begins as JSON does.
    """
    data, wrong = _decoded(text)
    fenced = [found[2] for found in _FENCE.finditer(text) if _BEGIN.match(found[2].lstrip())]
    if not wrong:
        yield data, ""
    elif fenced:
        yield from map(_decoded, fenced)
    else:
        yield from _bare(text)


def _bare(text: str) -> Iterator[tuple[Any, str]]:
    at = 0
    while begin := _BEGIN.search(text, at):
        at = begin.start()
        try:
            data, at = _DECODER.raw_decode(text, at)
            yield data, ""
        except (ValueError, RecursionError) as error:
            at += 1
            words = isinstance(error, json.JSONDecodeError) and not text[at : error.pos].strip()
            if not words:  # it began as JSON: what is inside of it is not the answer
                yield None, _words(error)
                return


def _decoded(text: str) -> tuple[Any, str]:
    try:
        return _DECODER.decode(text.strip()), ""
    except (ValueError, RecursionError) as error:
        return None, _words(error)


def _words(error: Exception) -> str:
    if isinstance(error, json.JSONDecodeError):
        near = " ".join(error.doc[max(0, error.pos - 20) : error.pos + 20].split())
        return f"It is no JSON: {error.msg} at line {error.lineno}, near {near!r}."
    return f"It is no JSON: {error if isinstance(error, ValueError) else 'it is nested too deeply'}."


def _pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice!r} is given twice in one object")
    return found


def _constant(name: str) -> float:
    raise ValueError(f"{name} is no number of JSON")


_DECODER = json.JSONDecoder(object_pairs_hook=_pairs, parse_constant=_constant)


def _place(parts: Sequence[int | str]) -> str:
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text or "The whole"


def _given(fault: Any) -> str:
    if fault["type"] == "missing":
        return ""
    shown = json.dumps(fault["input"], ensure_ascii=False, default=str)
    return f" (given: {shown if len(shown) <= _LONGEST_VALUE else shown[:_LONGEST_VALUE] + '…'})"
