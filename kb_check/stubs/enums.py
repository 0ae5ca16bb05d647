"""Enumerations as Literal types. A long one that is used more than once has a name in ``bpy._enums``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_check.stubs.names import is_writable

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.symbols.records import EnumItem, Symbol

MODULE = "bpy._enums"
_LONGEST_INLINE = 8
# What RNA lists for an enumeration whose items are made while Blender runs.
_PLACEHOLDERS = (("DEFAULT",), ("NONE",), ("NULL",))
_RNA_NAME = re.compile(r"^rna_enum_(\w+?)(?:_items)?$")

Values = tuple[str, ...]


class Enums:
    """The enumerations of one Blender."""

    def __init__(self, symbols: Iterable[Symbol]) -> None:
        """Counts how often each list of values is used; Blender's own names for them come first."""
        used: dict[Values, int] = {}
        names: dict[Values, str] = {}
        for symbol in symbols:
            if symbol.kind == "enum":
                if found := _RNA_NAME.match(symbol.path):
                    names[values_of(symbol.enum_items)] = _camel(found[1])
                continue
            for row in (symbol, *symbol.parameters, *symbol.returns):
                if len(row.enum_items) > _LONGEST_INLINE:
                    values = values_of(row.enum_items)
                    used[values] = used.get(values, 0) + 1
                    owner = symbol.path.rpartition(".")[0] if row is symbol else symbol.path
                    names.setdefault(values, _camel(f"{owner.rpartition('.')[2]}_{row.name}"))
        self._names: dict[Values, str] = {}
        taken: set[str] = set()
        for values in sorted(values for values, count in used.items() if count > 1):
            name, number = names[values], 1
            while name in taken or not is_writable(name):
                number += 1
                name = f"{names[values]}{number}"
            taken.add(name)
            self._names[values] = name

    def text(self, items: Iterable[EnumItem]) -> str:
        """The type of one of these values."""
        values = values_of(items)
        if not values:
            return "str"
        name = self._names.get(values)
        return f"{MODULE}.{name}" if name else _literal(values)

    def lines(self) -> list[str]:
        """The stub of the named ones."""
        rows = sorted((name, values) for values, name in self._names.items())
        return [f"{name}: typing.TypeAlias = {_literal(values)}" for name, values in rows]


def values_of(items: Iterable[EnumItem]) -> Values:
    """The identifiers of an enumeration, each once; none where Blender puts them together while it runs."""
    values = tuple(dict.fromkeys(item.identifier for item in items))
    return () if values in _PLACEHOLDERS else values


def _literal(values: Values) -> str:
    return f"typing.Literal[{', '.join(map(repr, values))}]"


def _camel(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))
