"""What models cost, in US dollars per million tokens: list prices, as published in November 2026."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from simworlds.llm.messages import Usage

_DATE = re.compile(r"-(\d{8}|latest)$")
_MILLION = 1_000_000


@dataclass(frozen=True, slots=True)
class Price:
    """Dollars per million tokens in and out.

    What the prompt cache reads and writes costs the input's price times a factor. Prompts of more than ``long_from``
    tokens cost ``long_factor`` times as much, input and output.
    """

    input_usd: float
    output_usd: float
    cache_read: float = 0.1
    cache_write: float = 1.25
    long_from: int | None = None
    long_factor: float = 1.0

    def cost(self, usage: Usage) -> float:
        """Dollars for one request."""
        return sum(self.parts(usage).values())

    def parts(self, usage: Usage) -> dict[str, float]:
        """Dollars for one request by kind: the fields of Usage."""
        factor = (self.long_factor if self._is_long(usage.prompt) else 1.0) / _MILLION
        return {
            "input": usage.input * self.input_usd * factor,
            "cache_read": usage.cache_read * self.cache_read * self.input_usd * factor,
            "cache_write": usage.cache_write * self.cache_write * self.input_usd * factor,
            "output": usage.output * self.output_usd * factor,
        }

    def worst(self, prompt: int, output: int) -> float:
        """The most that a request of so many tokens can cost: nothing of it read from the cache, all written to it."""
        dearest = max(1.0, self.cache_write) * self.input_usd
        dollars = (prompt * dearest + output * self.output_usd) / _MILLION
        return dollars * (self.long_factor if self._is_long(prompt) else 1.0)

    def _is_long(self, prompt: int) -> bool:
        return self.long_from is not None and prompt > self.long_from


PRICES: dict[str, Price] = {
    "claude-haiku-5-5": Price(0.10, 0.50, long_from=100_000, long_factor=5.0),
    "claude-haiku-4-5": Price(1.00, 5.00),
    "claude-sonnet-5-5": Price(2.00, 10.00, cache_read=0.05),
    "claude-sonnet-5": Price(2.00, 10.00),
    "claude-sonnet-4-6": Price(3.00, 15.00),
    "claude-sonnet-4-5": Price(3.00, 15.00),
    "claude-opus-5-5": Price(4.00, 20.00, cache_read=0.05),
    "claude-opus-5": Price(5.00, 25.00),
    "claude-opus-4-8": Price(5.00, 25.00),
    "claude-opus-4-7": Price(5.00, 25.00),
    "claude-opus-4-6": Price(5.00, 25.00),
    "claude-opus-4-5": Price(5.00, 25.00),
    "claude-fable-5-2": Price(8.00, 40.00, cache_read=0.025),
    "claude-fable-5-1": Price(10.00, 50.00, cache_read=0.025),
    "claude-fable-5": Price(10.00, 50.00),
}


def undated(model: str) -> str:
    """A model's name as lists have it: without a date or ``latest`` behind it."""
    return _DATE.sub("", model)


class Prices:
    """The prices in use: the caller's (by the model's exact name) before the list's."""

    def __init__(self, own: Mapping[str, Price] | None = None) -> None:
        self._own = dict(own or {})

    def of(self, model: str) -> Price | None:
        """The price of ``model`` (its name with or without a date), None where none is known."""
        return self._own.get(model) or PRICES.get(undated(model))

    def cost(self, model: str, usage: Usage) -> float | None:
        """Dollars for one request; None without a known price."""
        price = self.of(model)
        return None if price is None else price.cost(usage)


def read_price(text: str) -> Price:
    """The price that a person wrote as ``IN/OUT`` (``4/20``), dollars per million tokens. Raises ValueError."""
    try:
        dollars_in, dollars_out = (float(part) for part in text.split("/"))
    except ValueError:
        dollars_in = dollars_out = -1.0
    if not (0 <= dollars_in < float("inf") and 0 <= dollars_out < float("inf")):
        raise ValueError(f"{text!r} is not a price. Give dollars per million tokens in and out, as 4/20.")
    return Price(dollars_in, dollars_out)
