"""Structured answers: JSON that fits a schema, however the model wraps it.

The JSON may be bare, in a fence, or in prose. It has to be strict JSON (no comments, no NaN, no repeated name) and to
fit the schema without coercion. Other answers are sent back with what is wrong, a few times, and are then held to the
schema where the API has structured outputs. The first is free: another form in one conversation costs the prompt cache.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar

from pydantic import BaseModel, ValidationError

from simworlds.llm.errors import CutShort, Misfit, Rejected, TooLong
from simworlds.llm.messages import Text, Tool, ToolResult, user
from simworlds.schemas.json_schema import schema_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from simworlds.llm.messages import Ask, Message, Model, Turn

T = TypeVar("T")
M = TypeVar("M", bound=BaseModel)
AnswerReader: TypeAlias = "Callable[[Any], tuple[T | None, Sequence[object]]]"
"""Takes decoded JSON; returns its value, or None and what is wrong with it, as sentences."""

_FENCE = re.compile(r"^[ \t]*(`{3,}|~{3,})[ \t]*(?:json\w*)?[ \t]*\n(.*?)^[ \t]*\1", re.MULTILINE | re.DOTALL)
_BEGIN = re.compile(r"[{\[]")
_MOST_PROBLEMS = 20
_LONGEST_VALUE = 80
_NONE = "There is no JSON in the answer."
_LATER = "Not executed: the answer has to be the requested JSON, without tool calls."


@dataclass(frozen=True, slots=True)
class StructuredAnswer(Generic[T]):
    """The value, the turn that contains it, and how many turns it took."""

    value: T
    turn: Turn
    tries: int


def ask_for(  # noqa: PLR0913
    model: Model,
    ask: Ask,
    reader: AnswerReader[T],
    *,
    tries: int = 3,
    on_text: Callable[[str], object] | None = None,
    form: Tool | None = None,
) -> StructuredAnswer[T]:
    """Asks until ``reader`` accepts the answer, at most ``tries`` times.

    ``form``: what answers are held to after one that did not fit; a server that does not take it is asked without.
    Raises Misfit (or CutShort) if it never does, and what the model raises.
    """
    messages, is_held = ask.messages, False
    for left in reversed(range(tries)):
        try:
            asked = replace(ask, messages=messages)
            turn, is_taken = _answer(model, asked, form if is_held else None, on_text)
        except CutShort as cut:
            if not left:
                raise
            # Sending back its beginning would not help.
            shorter = f"Your answer was cut off after {cut.turn.usage.output} tokens. Send it again, shorter."
            messages = (*messages, user(shorter))
            continue
        try:
            return StructuredAnswer(read(turn.text, reader), turn, tries - left)
        except Misfit as misfit:
            if not left:
                raise
            messages = (*messages, turn.message(), complaint(turn, misfit))
            is_held = is_held or form is not None
            form = form if is_taken else None
    raise ValueError(f"tries must be at least 1, not {tries}.")


def form_of(shape: type[BaseModel]) -> Tool:
    """A pydantic model as the form of an answer."""
    return Tool(shape.__name__, "", schema_of(shape))


def _answer(
    model: Model, ask: Ask, form: Tool | None, on_text: Callable[[str], object] | None
) -> tuple[Turn, bool]:
    """The turn, and whether the server takes the form. Schemas that one API takes are too large for another."""
    if form is None:
        return model.answer(ask, on_text), True
    try:
        return model.answer(replace(ask, form=form), on_text), True
    except TooLong:
        raise
    except Rejected as error:
        if error.status not in (400, 422):
            raise
        return model.answer(ask, on_text), False


def fits(shape: type[M]) -> AnswerReader[M]:
    """A reader for JSON that fits a pydantic model, with exactly the types of the schema."""

    def reader(data: Any) -> tuple[M | None, list[str]]:
        try:
            return shape.model_validate_json(json.dumps(data), strict=True), []
        except ValidationError as error:
            return None, [
                f"{_place(fault['loc'])}: {fault['msg']}{_given(fault)}."
                for fault in error.errors(include_url=False, include_context=False)
            ]

    return reader


def read(text: str, reader: AnswerReader[T]) -> T:
    """The value of the JSON in ``text``; of several, the last that fits. Raises Misfit."""
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
    """The message that tells a model what is wrong with its ``turn``, and to send it again."""
    listed = "\n".join(f"- {problem}" for problem in misfit.problems)
    words = f"Your answer cannot be taken as it is:\n{listed}\nSend the whole JSON again, corrected."
    refused = [ToolResult(call.id, (Text(_LATER),), failed=True) for call in turn.calls]
    return user(*refused, words)


def _values(text: str) -> Iterator[tuple[Any, str]]:
    """The JSON in a text, decoded, each with its error ("" for none).

    Of a text that is JSON as a whole, that; else of its JSON fences; else of everything that begins like JSON.
    """
    data, wrong = _decoded(text)
    fenced = [fence[2] for fence in _FENCE.finditer(text) if _BEGIN.match(fence[2].lstrip())]
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
            is_prose = isinstance(error, json.JSONDecodeError) and not text[at : error.pos].strip()
            if not is_prose:  # it began as JSON: what is inside of it is not the answer
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
        return f"It is not valid JSON: {error.msg} at line {error.lineno}, near {near!r}."
    return f"It is not valid JSON: {error if isinstance(error, ValueError) else 'it is nested too deeply'}."


def _pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice!r} occurs twice in one object")
    return data


def _constant(name: str) -> float:
    raise ValueError(f"{name} is not a JSON number")


_DECODER = json.JSONDecoder(object_pairs_hook=_pairs, parse_constant=_constant)


def _place(parts: Sequence[int | str]) -> str:
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text or "The whole"


def _given(fault: Any) -> str:
    if fault["type"] == "missing":
        return ""
    value = json.dumps(fault["input"], ensure_ascii=False, default=str)
    return f" (it is {value if len(value) <= _LONGEST_VALUE else value[:_LONGEST_VALUE] + '…'})"
