"""What an operator's poll wants of the active object, as data, and in words.

A leaf module: it imports nothing of the project.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_NAMED = 6
_ACTIVE = {
    "any": "any active object or none",
    "active": "an active object",
    "selected": "an active and selected object",
}


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which types, or modes, of active objects an operator runs with: these ``names``, or all others."""

    names: tuple[str, ...]
    is_others: bool = False

    @classmethod
    def of(cls, row: Mapping[str, Any] | None) -> Wanted | None:
        """From what JSON makes of one, if there is one."""
        return cls(tuple(row["names"]), row["is_others"]) if row else None

    def takes(self, name: str) -> bool:
        """Whether an operator runs with a type, or in a mode."""
        return (name in self.names) != self.is_others

    def text(self, what: str) -> str:
        """`` of type 'MESH'|'CURVE'``, or ``, not in mode 'EDIT'``; ``what`` is what the names are of."""
        return f"{', not' if self.is_others else ''} {what} {_listed(self.names)}"


@dataclass(frozen=True, slots=True)
class Case:
    """Types of active objects, and in which modes an operator runs with these; None for all modes."""

    types: tuple[str, ...]
    modes: Wanted | None = None

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Case:
        """From what JSON makes of one."""
        return cls(tuple(row["types"]), Wanted.of(row["modes"]))

    @property
    def text(self) -> str:
        """``'MESH' (not in mode 'EDIT')``."""
        return _listed(self.types) + (f" ({self.modes.text('in mode').strip(', ')})" if self.modes else "")


@dataclass(frozen=True, slots=True)
class OperatorNeeds:
    """What an operator wants, of all that was tried; nothing of it all where it refused nothing.

    ``active``: that an object is active, or is selected as well, or any or none will do; empty where it does not
    matter. Of which ``types`` it is, in which ``modes``; or else one of the ``cases``; ``in_some_modes`` where there
    are too many of these. ``modes_of_some`` are those in which it runs with some types only. ``calls`` must have been
    made before, which ``sets`` something rather than adds it; ``with_modifier``: the object must have any modifier.
    """

    active: Literal["", "any", "active", "selected"] = ""
    types: Wanted | None = None
    modes: Wanted | None = None
    cases: tuple[Case, ...] = ()
    in_some_modes: bool = False
    modes_of_some: tuple[str, ...] = ()
    calls: tuple[str, ...] = ()
    with_modifier: bool = False
    sets: bool = False

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> OperatorNeeds:
        """From what JSON makes of one; what it leaves out is not wanted."""
        return cls(
            row.get("active", ""),
            Wanted.of(row.get("types")),
            Wanted.of(row.get("modes")),
            tuple(map(Case.of, row.get("cases", ()))),
            row.get("in_some_modes", False),
            tuple(row.get("modes_of_some", ())),
            tuple(row.get("calls", ())),
            row.get("with_modifier", False),
            row.get("sets", False),
        )

    @property
    def text(self) -> str:
        """``an active object of type 'MESH' in mode 'EDIT'``; empty where it refused nothing."""
        does = "sets" if self.sets else "adds"
        added = f"what `{'`, then `'.join(self.calls)}` {does}" if self.calls else ""
        if not self.active:
            return added
        parts = (
            _ACTIVE[self.active],
            self.types.text("of type") if self.types else "",
            f" of type {' or '.join(case.text for case in self.cases)}" if self.cases else "",
            self.modes.text("in mode") if self.modes else "",
            " in some modes" if self.in_some_modes else "",
            f", and only some types in mode {_listed(self.modes_of_some)}" if self.modes_of_some else "",
            " with a modifier" if self.with_modifier else "",
            f" with {added}" if added else "",
        )
        return "".join(parts)

    @property
    def mode_to_enter(self) -> str:
        """A mode in which it runs: the first that it wants, or Object Mode where it refuses one; empty for any."""
        modes = next((one for one in (self.modes, *(case.modes for case in self.cases)) if one), None)
        if modes:
            return "OBJECT" if modes.is_others else modes.names[0]
        return next(iter(self.modes_of_some), "")


def _listed(names: Iterable[str]) -> str:
    """``'MESH'|'CURVE'``."""
    shown = [repr(name) for name in names]
    return "|".join(shown[:_NAMED]) + ("|…" if len(shown) > _NAMED else "")
