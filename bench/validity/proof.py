"""The proof of a property of a scene: a row for each test, with its outcome."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Property = Literal["satisfiable", "counterfeits", "mutations", "invariance", "deterministic"]
PROPERTIES: tuple[Property, ...] = ("satisfiable", "counterfeits", "mutations", "invariance", "deterministic")
OLD_NAMES: dict[str, Property] = {"twins": "counterfeits", "sabotages": "mutations", "fair": "invariance"}


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ProofRow(_Part):
    """One test. ``holds``: None where it does not apply. ``why``: in words, what is wrong or missing.

    ``values``: what was measured, as JSON.
    """

    name: str
    holds: bool | None
    why: str = ""
    values: dict[str, Any] = Field(default_factory=dict[str, Any])


class Proof(_Part):
    """The proof of one property. ``unable``: why it could not be tested; then there are no rows."""

    scene: str
    about: Property
    rows: tuple[ProofRow, ...] = ()
    unable: str = ""
    seconds: float = 0.0

    @property
    def holds(self) -> bool | None:
        """Whether all tests passed; None where none applies."""
        tried = [row.holds for row in self.rows if row.holds is not None]
        return all(tried) if tried else None

    @property
    def faults(self) -> tuple[ProofRow, ...]:
        """The tests that failed."""
        return tuple(row for row in self.rows if row.holds is False)
