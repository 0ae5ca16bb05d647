"""A fault of a plan."""

from __future__ import annotations

from dataclasses import dataclass

MOST_FAULTS = 200  # that are looked for: whoever mends these asks again


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a plan: ``path`` names the field (``relations[3].parents[0]``), ``message`` is a sentence."""

    path: str
    message: str

    def __str__(self) -> str:
        return f"{self.path}: {self.message}"
