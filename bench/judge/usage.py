"""Tokens and cost of answers."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, NonNegativeInt


class TokenUsage(BaseModel):
    """Numbers of tokens. ``cached``: the part of ``input`` from the provider's cache, which costs less."""

    model_config = ConfigDict(frozen=True)

    input: NonNegativeInt = 0
    output: NonNegativeInt = 0
    cached: NonNegativeInt = 0


class AnswerCost(BaseModel):
    """Tokens, and their list price in US dollars; None if a price is unknown."""

    model_config = ConfigDict(frozen=True)

    usage: TokenUsage = TokenUsage()
    cost: float | None = 0.0
