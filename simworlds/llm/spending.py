"""Counts tokens and cost by role and stage, and enforces a limit.

The limit is a promise: a call is made only if its worst case (nothing of it read from the prompt cache, an answer of
the greatest length) still fits beside the worst case of every call under way. Recorded turns cost nothing.
"""

from __future__ import annotations

import threading
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from simworlds.llm import tokens
from simworlds.llm.errors import ModelError, OverBudget, Stopped
from simworlds.llm.messages import Usage
from simworlds.llm.prices import Prices

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from simworlds.llm.apis.retries import Retry
    from simworlds.llm.messages import Ask, Model, Turn

_MARGIN = 1.3  # factor by which token estimates may fall short, until real counts are known
_SURE = 1.1  # on top of the worst factor seen


@dataclass(frozen=True, slots=True)
class SpendingRow:
    """What one role used in one stage. ``cost`` (dollars) leaves out the ``unpriced`` of the ``calls``.

    ``recorded`` turns came from a record; no other number includes them.
    """

    role: str
    stage: str
    calls: int = 0
    usage: Usage = field(default_factory=Usage)
    cost: float = 0.0
    unpriced: int = 0
    recorded: int = 0

    @classmethod
    def paid(cls, role: str, stage: str, turn: Turn) -> SpendingRow:
        """What a turn that was paid for has used."""
        return cls(role, stage, 1, turn.usage + turn.lost, turn.cost or 0.0, int(turn.cost is None))

    def __add__(self, other: SpendingRow) -> SpendingRow:
        return SpendingRow(
            self.role if self.role == other.role else "",
            self.stage if self.stage == other.stage else "",
            self.calls + other.calls,
            self.usage + other.usage,
            self.cost + other.cost,
            self.unpriced + other.unpriced,
            self.recorded + other.recorded,
        )


class Spending:
    """What a run has spent. Safe to use from several threads."""

    def __init__(self, max_cost: float | None = None, prices: Prices | None = None) -> None:
        """``max_cost`` is in US dollars; None: no limit. Raises ValueError for an invalid one."""
        if max_cost is not None and not max_cost >= 0:
            raise ValueError(f"A spending limit of {max_cost} is invalid. Give US dollars, 0 or more.")
        self.max_cost = max_cost
        self._prices = prices or Prices()
        self._rows: dict[tuple[str, str], SpendingRow] = {}
        self._held = 0.0
        self._margins: dict[str, float] = {}
        self._lock = threading.Lock()

    def rows(self) -> tuple[SpendingRow, ...]:
        """What was used, by role and stage, in the order in which they first spent."""
        with self._lock:
            return tuple(self._rows.values())

    def total(self) -> SpendingRow:
        """All rows in one, its role and stage empty."""
        return sum(self.rows(), SpendingRow("", ""))

    def worst(self, ask: Ask) -> float | None:
        """The most that ``ask`` can cost, in dollars; None without a known price."""
        price = self._prices.of(ask.model)
        margin = self._margins.get(ask.model, _MARGIN)
        return None if price is None else price.worst(int(tokens.of_ask(ask) * margin), ask.max_tokens)

    @contextmanager
    def held(self, ask: Ask) -> Generator[None]:
        """Holds the worst case of ``ask`` while it is made. Raises OverBudget where it does not fit."""
        if self.max_cost is None:
            yield
            return
        worst = self.worst(ask)
        if worst is None:
            raise OverBudget(no_price(ask.model, self.max_cost))
        with self._lock:
            spent = self._spent()
            if spent + self._held + worst > self.max_cost:
                raise OverBudget(self._short(ask, spent, worst))
            self._held += worst
        try:
            yield
        finally:
            with self._lock:
                self._held -= worst

    def count(self, ask: Ask, turn: Turn) -> None:
        """Counts an answer."""
        if not turn.live:
            self._add(SpendingRow(ask.role, ask.stage, recorded=1))
            return
        self._learn(ask, turn.usage)
        self._add(SpendingRow.paid(ask.role, ask.stage, turn))

    def count_lost(self, ask: Ask, lost: Usage) -> None:
        """Counts the usage of attempts without an answer."""
        if lost != Usage():
            cost = self._prices.cost(ask.model, lost)
            self._add(SpendingRow(ask.role, ask.stage, 0, lost, cost or 0.0, int(cost is None)))

    def carry(self, role: str, stage: str, turn: Turn) -> None:
        """Counts a turn that this run paid for before it was resumed."""
        self._add(SpendingRow.paid(role, stage, turn))

    def before_retry(self, retry: Retry) -> None:
        """For Claude's ``tell``: raises OverBudget if the limit does not allow the retry."""
        if self.max_cost is None:
            return
        lost = self._prices.cost(retry.ask.model, retry.lost) or 0.0
        with self._lock:  # the call's own worst case is held already
            spent = self._spent()
            over = spent + self._held + lost > self.max_cost
        if over:
            error = OverBudget(self._short(retry.ask, spent + lost, self.worst(retry.ask) or 0.0))
            error.lost = retry.lost
            raise error

    def _spent(self) -> float:
        return sum(row.cost for row in self._rows.values())

    def _short(self, ask: Ask, spent: float, worst: float) -> str:
        left = max(0.0, (self.max_cost or 0.0) - spent)
        return (
            f"The limit of ${self.max_cost:.2f} is reached: ${spent:.2f} are spent, and the {ask.role}'s next call "
            f"could cost ${worst:.2f}, more than the ${left:.2f} that are left."
        )

    def _learn(self, ask: Ask, usage: Usage) -> None:
        with self._lock:
            seen = usage.prompt / max(1, tokens.of_ask(ask))
            self._margins[ask.model] = max(self._margins.get(ask.model, 1.0), seen * _SURE)

    def _add(self, row: SpendingRow) -> None:
        with self._lock:
            key = (row.role, row.stage)
            self._rows[key] = self._rows.get(key, SpendingRow(row.role, row.stage)) + row


def no_price(model: str, max_cost: float) -> str:
    """Why a limit cannot be kept, and what to do."""
    return (
        f"No price is known for the model {model!r}, so the limit of ${max_cost:.2f} cannot be kept. Give its price, "
        "in dollars per million tokens, or no limit."
    )


class Metered:
    """A Model whose answers are counted, and which makes no call beyond the limit.

    Put it around the live model only: around a record it would reserve money for calls that cost nothing.
    """

    def __init__(self, model: Model, spending: Spending) -> None:
        self._model = model
        self._spending = spending

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn, see Model. Raises OverBudget before a call that might cost too much."""
        with self._spending.held(ask):
            try:
                turn = self._model.answer(ask, on_text)
            except Stopped as stopped:
                self._spending.count(ask, stopped.turn)
                raise
            except ModelError as error:
                if error.lost:
                    self._spending.count_lost(ask, error.lost)
                raise
            self._spending.count(ask, turn)
            return turn
