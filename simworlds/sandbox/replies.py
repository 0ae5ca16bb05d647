"""What a worker sends, checked before anything is done by it.

Hostile code runs in the worker's process and can answer in its name, so a message is a claim: its shape, its lengths
and its numbers are checked here, and what a tool returns by the reader that its caller gives.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from collections.abc import Mapping

LONGEST_TEXT = 20_000
_READING = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, AssertionError)

T = TypeVar("T")
Reader = Callable[[Any], T]
"""Makes a value of what a tool returned; LookupError, TypeError, ValueError and the like say that it is malformed."""

# What claims are made of: a text, a name, a path, a number of things, a frame, a side in pixels.
Text = Annotated[str, Field(max_length=LONGEST_TEXT)]
Name = Annotated[str, Field(max_length=1000)]
Place = Annotated[str, Field(max_length=4096)]
Count = Annotated[int, Field(ge=0, le=1 << 48)]
Frame = Annotated[int, Field(ge=-1_048_574, le=1_048_574)]
Side = Annotated[int, Field(ge=4, le=16_384)]


class Malformed(Exception):  # noqa: N818 - reads as the state it names
    """A message or a tool's value is not what it must be."""


class Claim(BaseModel):
    """The base of models for what a worker sends: no further fields, no infinite numbers."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, protected_namespaces=())


class ProgressMessage(Claim):
    """A call goes on: (done, total, text)."""

    ticket: str
    progress: tuple[float, float | None, Text]


class AnswerMessage(Claim):
    """A call has ended, with a ``value`` or with what went wrong; ``left``: what cannot be undone, in words."""

    ticket: str
    seconds: float = Field(ge=0)
    left: list[Text] = Field(max_length=20)
    value: Any = None
    refused: Text | None = None
    missing: Text | None = None
    failed: Text | None = None
    traceback: Text = ""


def parse_message(message: Mapping[str, Any]) -> ProgressMessage | AnswerMessage:
    """A message of the channel as data. Raises Malformed."""
    try:
        kind = ProgressMessage if "progress" in message else AnswerMessage
        return kind.model_validate(message)
    except ValidationError as error:
        raise Malformed(first_fault(error)) from None


def parse_value(read: Reader[T], value: Any) -> T:
    """What a tool returned, read. Raises Malformed."""
    try:
        return read(value)
    except ValidationError as error:
        raise Malformed(first_fault(error)) from None
    except (*_READING, RecursionError) as error:
        raise Malformed(f"{type(error).__name__}: {str(error)[:200]}") from error


def nothing(value: Any) -> None:
    """Reads the value of a tool of which only the end matters."""
    del value


def mapping(value: Any) -> dict[str, Any]:
    """Reads a JSON object, to be looked at with care."""
    if not isinstance(value, dict):
        raise TypeError("it is not a JSON object")
    return value


def unread(value: Any) -> Any:
    """Passes a value on as it is, to a caller that reads it with models of its own."""
    return value
