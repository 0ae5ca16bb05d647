"""One question, asked until its answer is one, and what that used up."""

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
"""How often an answer may be wrong."""
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
    """What was answered, by which model (as the provider names it), and what all tries together used up."""

    value: T
    by: str
    spent: Spent


def asked(provider: Provider, ask: Ask, reader: AnswerReader[T]) -> Answered[T]:
    """Asks; an answer that ``reader`` does not take goes back with what is wrong, a few times. Raises NotJudged."""
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
        return f"The answer was none, {TRIES} times: {' '.join(str(error).split())}"[:600]
    return str(error)


def _spent(spending: Spending) -> Spent:
    row = spending.total()
    usage = Usage(input=row.usage.prompt, output=row.usage.output, cached=row.usage.cache_read)
    return Spent(usage=usage, cost=None if row.unpriced else row.cost)
