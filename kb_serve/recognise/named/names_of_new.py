"""What Blender calls new modifiers and constraints that a script gives no name: not always as menus and types do."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_MODIFIERS, _CONSTRAINTS = "modifiers", "constraints"
# Holder → the class of what it holds, and what makes such by a type.
_MAKERS = {
    _MODIFIERS: (f"{TYPES}Modifier", (f"{TYPES}ObjectModifiers.new",)),
    _CONSTRAINTS: (
        f"{TYPES}Constraint",
        (f"{TYPES}ObjectConstraints.new", f"{TYPES}PoseBoneConstraints.new"),
    ),
}
_NAMED = re.compile(r'\("([^"]+)"')
_CALLED = {"IK": "IK"}  # of the constraints the one that is not called by its label


class NameOfNew(NamedTuple):
    """The type of a modifier or a constraint, and what a new one is called."""

    choice: str
    name: str


class NamesOfNew:
    """Finds in one base what is called by default what a key may have meant."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def meant(self, holder: str, asked: str) -> NameOfNew | None:
        """What one of some type is called that a key names by its label or type; None where that is its name."""
        found = self._names.get(holder, {}).get(key(asked))
        return found if found and found.name != asked else None

    @cached_property
    def _names(self) -> dict[str, dict[str, NameOfNew]]:
        return {holder: dict(self._known(holder)) for holder in _MAKERS}

    def _known(self, holder: str) -> Iterator[tuple[str, NameOfNew]]:
        cls, makers = _MAKERS[holder]
        types = self._reader.symbol(f"{cls}.type")
        labels = {item.identifier: item.name for item in types.enum_items} if types else {}
        for maker in makers:
            for call, choice in self._reader.makers.calls_of(maker):
                named, label = _NAMED.search(call), labels.get(choice, "")
                name = named[1] if named and holder == _MODIFIERS else _CALLED.get(choice, label)
                if name:
                    yield from (
                        (key(asked), NameOfNew(choice, name)) for asked in (choice, label, name) if asked
                    )
