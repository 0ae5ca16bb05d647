"""What a run cost, by role and by kind: tokens in, read from the prompt cache, written to it, out; and pictures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pydantic import ValidationError

from agents.loop.options import BEFORE_DRAFTS, Options
from agents.loop.record.run_state import ModelCall
from simworlds.llm.messages import Usage
from simworlds.llm.prices import Prices

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.loop.record.run_state import RunState

KINDS = {"input": "Input", "cache_read": "Cache read", "cache_write": "Cache write", "output": "Output"}


@dataclass(slots=True)
class CostRow:
    """What a role, or all of them, used. ``dollars`` are by kind; ``pictures`` were sent to the model."""

    role: str
    calls: int = 0
    pictures: int = 0
    usage: Usage = field(default_factory=Usage)
    dollars: dict[str, float] = field(default_factory=lambda: dict.fromkeys(KINDS, 0.0))
    unpriced: int = 0

    @property
    def cost(self) -> float:
        """Dollars in all, without the ``unpriced`` calls."""
        return sum(self.dollars.values())

    def add(self, call: ModelCall, parts: Mapping[str, float] | None) -> None:
        """Counts a call whose dollars by kind are ``parts``, None without a known price."""
        assert call.turn is not None
        self.calls += 1
        self.pictures += call.pictures
        self.usage += call.turn.usage + call.turn.lost
        self.unpriced += parts is None
        for kind, dollars in (parts or {}).items():
            self.dollars[kind] += dollars


def costs_by_role(run_state: RunState) -> list[CostRow]:
    """A row for each role whose answers were live, in the order in which they were asked, and a last one for all."""
    prices = _prices(run_state)
    rows: dict[str, CostRow] = {}
    total = CostRow("")
    for call in run_state.all_steps():
        if not isinstance(call, ModelCall) or call.turn is None or not call.turn.live:
            continue
        parts = _dollars(call, prices)
        for row in (rows.setdefault(call.role, CostRow(call.role)), total):
            row.add(call, parts)
    return [*rows.values(), total] if rows else []


def _prices(run_state: RunState) -> Prices:
    try:
        return Options.model_validate({**BEFORE_DRAFTS, "prompt": "-", **run_state.options}).prices
    except ValidationError:  # a journal of another version
        return Prices()


def _dollars(call: ModelCall, prices: Prices) -> dict[str, float] | None:
    """What was paid, split by the price's weights: the sum is what the journal has."""
    turn = call.turn
    assert turn is not None
    if turn.cost is None:
        return None
    price = prices.of(call.model) or prices.of(turn.model)
    parts = price.parts(turn.usage + turn.lost) if price else {}
    whole = sum(parts.values())
    if not whole:
        return {"input": turn.cost}
    return {kind: dollars * turn.cost / whole for kind, dollars in parts.items()}
