"""What was proven of a scene: a property, what was tried, and what came of it. Leaf."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Property = Literal["satisfiable", "twins", "sabotages", "fair", "deterministic"]
PROPERTIES: tuple[Property, ...] = ("satisfiable", "twins", "sabotages", "fair", "deterministic")


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Row(_Part):
    """One thing that was tried. ``holds``: None where it does not apply. ``why``: in words, what is wrong, or missing.

    ``values`` are JSON: what was measured.
    """

    name: str
    holds: bool | None
    why: str = ""
    values: dict[str, Any] = Field(default_factory=dict[str, Any])


class Proof(_Part):
    """A property of a scene. ``unable``: why it could not be looked into; then there are no rows."""

    scene: str
    about: Property
    rows: tuple[Row, ...] = ()
    unable: str = ""
    seconds: float = 0.0

    @property
    def holds(self) -> bool | None:
        """Whether everything that was tried came out as it must; None where nothing applies."""
        tried = [row.holds for row in self.rows if row.holds is not None]
        return all(tried) if tried else None

    @property
    def faults(self) -> tuple[Row, ...]:
        """What did not come out so."""
        return tuple(row for row in self.rows if row.holds is False)
