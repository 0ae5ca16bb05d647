"""What answers use up."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, NonNegativeInt


class Usage(BaseModel):
    """Tokens. ``cached`` are those of the ``input`` that the provider had kept, and charges less for."""

    model_config = ConfigDict(frozen=True)

    input: NonNegativeInt = 0
    output: NonNegativeInt = 0
    cached: NonNegativeInt = 0


class Spent(BaseModel):
    """Tokens, and their list price in US dollars; None where a price is not known."""

    model_config = ConfigDict(frozen=True)

    usage: Usage = Usage()
    cost: float | None = 0.0
