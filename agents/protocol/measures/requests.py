"""Requests for measurements, and the answers of Blender. Metres, radians, frames.

A request is a frozen record; equal requests are measured once. Blender answers all requests in one batch and steps
through the frames that they name in order. The frame ``None`` is the scene's current one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from collections.abc import Iterable

Names = tuple[str, ...]
# Takes requests as JSON; gives an answer for each, in order: {"value": …} or {"unmeasured": reason}.
MeasureInBlender = Callable[[list[dict[str, Any]]], list[dict[str, Any]]]


class Measure(BaseModel):
    """Base class of what was measured."""

    model_config = ConfigDict(frozen=True, extra="ignore")


Answer = TypeVar("Answer", bound=Measure)


class Unmeasured(Exception):  # noqa: N818 - a state, not a failure
    """A measure is missing; the message says why."""


@dataclass(frozen=True)
class Request(Generic[Answer]):
    """Base class of the requests. ``kind`` names the function that measures, ``answer`` the type of its result."""

    kind: ClassVar[str]
    answer: ClassVar[type[Measure]]

    def __init_subclass__(cls, *, kind: str, answer: type[Measure]) -> None:
        super().__init_subclass__()
        cls.kind = kind
        cls.answer = answer

    def as_json(self) -> dict[str, Any]:
        """The request as Blender reads it."""
        return {"kind": self.kind, **asdict(self)}


class Measures:
    """The answers to a batch of requests. Looking up what was not measured raises Unmeasured with the reason."""

    def __init__(self, answers: dict[Request[Any], Measure | str]) -> None:
        self._answers = answers

    def __getitem__(self, request: Request[Answer]) -> Answer:
        answer = self._answers.get(request)
        if answer is None:
            raise Unmeasured("it was not requested")
        if isinstance(answer, str):
            raise Unmeasured(answer)
        return answer  # pyright: ignore[reportReturnType] - the answer's type is the request's own


def measure(requests: Iterable[Request[Any]], measure_in_blender: MeasureInBlender) -> Measures:
    """Has a batch of requests measured."""
    unique = list(dict.fromkeys(requests))
    answers: dict[Request[Any], Measure | str] = {}
    if unique:
        replies = measure_in_blender([request.as_json() for request in unique])
        if len(replies) != len(unique):
            reason = f"Blender gave {len(replies)} answers to {len(unique)} requests"
            replies = [{"unmeasured": reason}] * len(unique)
        for request, reply in zip(unique, replies, strict=True):
            if "value" in reply:
                try:
                    answers[request] = request.answer.model_validate(reply["value"])
                except ValidationError as error:
                    answers[request] = f"Blender's answer is invalid: {first_fault(error)}"
            else:
                answers[request] = str(reply.get("unmeasured") or "Blender gave no answer")
    return Measures(answers)
