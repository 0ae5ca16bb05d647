"""Asks a model one question, again if the answer is not valid, and counts the cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from bench.judge.errors import NotJudged, Reason
from bench.judge.usage import Spent, Usage
from simworlds.llm.errors import CutShort, Misfit, ModelError, OverBudget, Refused, Rejected, Unreachable
from simworlds.llm.spending import Metered, Spending
from simworlds.llm.structured import ask_for

if TYPE_CHECKING:
    from bench.judge.providers import Provider
    from simworlds.llm.messages import Ask
    from simworlds.llm.structured import AnswerReader

T = TypeVar("T")
TRIES = 3
"""Attempts at a valid answer."""
_REASONS: tuple[tuple[type[ModelError], Reason], ...] = (
    (OverBudget, "over budget"),
    (Refused, "refused"),
    (CutShort, "cut short"),
    (Misfit, "malformed"),
    (Rejected, "rejected"),
    (Unreachable, "unreachable"),
)


@dataclass(frozen=True, slots=True)
class Answered(Generic[T]):
    """The answer, the model that gave it (as the provider names it), and the cost of all attempts."""

    value: T
    by: str
    spent: Spent


def asked(provider: Provider, ask: Ask, reader: AnswerReader[T]) -> Answered[T]:
    """Asks a question; an invalid answer goes back with its faults, up to TRIES times in all. Raises NotJudged."""
    spending = Spending(prices=provider.prices)
    try:
        found = ask_for(Metered(provider, spending), ask, reader, tries=TRIES)
    except ModelError as error:
        raise NotJudged(_reason(error), _words(error), _spent(spending)) from error
    return Answered(found.value, found.turn.model, _spent(spending))


def _reason(error: ModelError) -> Reason:
    for kind, reason in _REASONS:
        if isinstance(error, kind):
            return reason
    return "unreachable"


def _words(error: ModelError) -> str:
    if isinstance(error, Misfit):
        return f"All {TRIES} answers were invalid. The last: {' '.join(str(error).split())}"[:600]
    return str(error)


def _spent(spending: Spending) -> Spent:
    row = spending.total()
    usage = Usage(input=row.usage.prompt, output=row.usage.output, cached=row.usage.cache_read)
    return Spent(usage=usage, cost=None if row.unpriced else row.cost)
