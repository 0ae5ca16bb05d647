"""Asks a model one question, again if the answer is not valid, and counts the cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pydantic import BaseModel

from bench.judge.errors import NotJudged, Reason
from bench.judge.usage import AnswerCost, TokenUsage
from simworlds.llm.errors import CutShort, Declined, Misfit, ModelError, OverBudget, Rejected, Unreachable
from simworlds.llm.spending import Metered, Spending
from simworlds.llm.structured import ask_for, fits

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from bench.judge.providers import JudgeProvider
    from simworlds.llm.messages import Ask
    from simworlds.llm.structured import AnswerReader

T = TypeVar("T")
M = TypeVar("M", bound=BaseModel)
TRIES = 3
"""Attempts at a valid answer."""
_REASONS: tuple[tuple[type[ModelError], Reason], ...] = (
    (OverBudget, "over budget"),
    (Declined, "refused"),
    (CutShort, "cut short"),
    (Misfit, "malformed"),
    (Rejected, "rejected"),
    (Unreachable, "unreachable"),
)


@dataclass(frozen=True, slots=True)
class JudgeAnswer(Generic[T]):
    """The answer, the model that gave it (as the provider names it), and the cost of all attempts."""

    value: T
    by: str
    spent: AnswerCost


def ask_judge(provider: JudgeProvider, ask: Ask, reader: AnswerReader[T]) -> JudgeAnswer[T]:
    """Asks a question; an invalid answer goes back with its faults, up to TRIES times in all. Raises NotJudged."""
    spending = Spending(prices=provider.prices)
    try:
        reply = ask_for(Metered(provider, spending), ask, reader, tries=TRIES)
    except ModelError as error:
        raise NotJudged(_reason(error), _describe(error), _spent(spending)) from error
    return JudgeAnswer(reply.value, reply.turn.model, _spent(spending))


def checked_reader(shape: type[M], find_faults: Callable[[M], Iterable[str]]) -> AnswerReader[M]:
    """Accepts data of that shape in which ``find_faults`` finds none."""
    read = fits(shape)

    def reader(data: Any) -> tuple[M | None, Sequence[object]]:
        value, misfits = read(data)
        if value is None:
            return None, misfits
        faults = list(find_faults(value))
        return (None, faults) if faults else (value, [])

    return reader


def _reason(error: ModelError) -> Reason:
    for kind, reason in _REASONS:
        if isinstance(error, kind):
            return reason
    return "unreachable"


def _describe(error: ModelError) -> str:
    if isinstance(error, Misfit):
        return f"All {TRIES} answers were invalid. The last: {' '.join(str(error).split())}"[:600]
    return str(error)


def _spent(spending: Spending) -> AnswerCost:
    row = spending.total()
    usage = TokenUsage(input=row.usage.prompt, output=row.usage.output, cached=row.usage.cache_read)
    return AnswerCost(usage=usage, cost=None if row.unpriced else row.cost)
