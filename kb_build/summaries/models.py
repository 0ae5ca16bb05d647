"""Facts about Claude's models that requests and costs depend on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from kb_build.errors import SummaryError
from kb_build.summaries.types import TokenPrice
from simworlds.llm.prices import PRICES, undated

BATCH_DISCOUNT = 0.5
"""What a token costs in a message batch, as a share of its price."""

FALLBACK_CHARS_PER_TOKEN = 3.0
"""English with identifiers, on the cautious side; used where the API does not count tokens for us."""

Thinking: TypeAlias = Literal["disable", "effort", "none", "unknown"]


@dataclass(frozen=True, slots=True)
class ModelFacts:
    """One model's list price, and how it is kept from thinking at length over one page.

    ``thinking``: ``"disable"`` (the request may switch it off), ``"effort"`` (it may only be told to take it
    easy), ``"none"`` (it does not think unless asked to), ``"unknown"``.
    """

    price: TokenPrice | None
    thinking: Thinking

    @property
    def max_tokens(self) -> int:
        """The most output tokens that one request may use: a summary needs about 100, thinking far more."""
        return 1024 if self.thinking in ("disable", "none") else 4096

    @property
    def expected_tokens(self) -> int:
        """The output tokens that a request is expected to use."""
        return 120 if self.thinking in ("disable", "none") else 500


_THINKING: dict[str, Thinking] = {
    "claude-haiku-5-5": "disable",
    "claude-haiku-4-5": "none",
    "claude-sonnet-5-5": "effort",
    "claude-sonnet-5": "effort",
    "claude-sonnet-4-6": "none",
    "claude-sonnet-4-5": "none",
    "claude-opus-5-5": "effort",
    "claude-opus-5": "disable",
    "claude-opus-4-8": "none",
    "claude-opus-4-7": "none",
    "claude-opus-4-6": "none",
    "claude-opus-4-5": "none",
    "claude-fable-5-2": "effort",
    "claude-fable-5-1": "effort",
}


def facts(model: str) -> ModelFacts:
    """The facts of ``model`` (its name with or without a date)."""
    name = undated(model)
    listed = PRICES.get(name)  # dearer long prompts do not count: the cap on a page's length rules them out
    price = TokenPrice(listed.input_usd, listed.output_usd) if listed is not None else None
    return ModelFacts(price, _THINKING.get(name, "unknown"))


def price_of(model: str, override: TokenPrice | None) -> TokenPrice:
    """The price to reckon with; ``override`` wins. Raises SummaryError for a model without a known price."""
    price = override or facts(model).price
    if price is None:
        raise SummaryError(
            f"No price is known for the model {model!r}, so its cost cannot be estimated. Give its price (US "
            f"dollars per million input and output tokens), or use one of: {', '.join(PRICES)}."
        )
    return price


def batch_cost(price: TokenPrice, input_tokens: float, output_tokens: float) -> float:
    """What so many tokens cost in a message batch, in US dollars."""
    usd = input_tokens * price.input_usd + output_tokens * price.output_usd
    return usd * BATCH_DISCOUNT / 1_000_000
