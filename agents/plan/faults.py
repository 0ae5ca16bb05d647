"""A fault of a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simworlds.counting import format_list

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST_FAULTS = 200  # that are looked for: whoever mends these asks again
_PLACES = 12  # that are named of one fault


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a plan: ``path`` names the field (``relations[3].parents[0]``), ``message`` is a sentence."""

    path: str
    message: str

    def __str__(self) -> str:
        return f"{self.path}: {self.message}"


def grouped(faults: Iterable[Fault]) -> list[Fault]:
    """The same faults for a list that is read: what is wrong in several places is one, with all of these."""
    places: dict[str, list[str]] = {}
    for fault in faults:
        places.setdefault(fault.message, []).append(fault.path)
    return [Fault(format_list(paths, _PLACES), message) for message, paths in places.items()]
