"""Finds the classes, members and functions that messages name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader


class NamedSymbols:
    """Finds in one base what a message names."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def class_path(self, name: str, *, or_module: bool = True) -> str:
        """The path of a class that a message names, or else a module if ``or_module``; empty where there is none.

        What is spelled exactly so comes before what has the same letters.
        """
        kinds = ("class", "module") if or_module else ("class",)
        for candidate in (TYPES + name, name):
            if (entry := self._reader.entry(candidate)) and (or_module or entry.kind in kinds):
                return candidate
        spelled = [identifier for _, identifier in self._reader.names.by_key(key(name))]
        found = [entry for entry in map(self._reader.entry, spelled) if entry and entry.kind in kinds]
        last = name.rpartition(".")[2]
        first = min(found, key=lambda entry: (entry.name != last, kinds.index(entry.kind)), default=None)
        return first.path if first else ""

    def member(self, owner: str, name: str) -> SymbolEntry | None:
        """What a class or module that a message names has of that name."""
        cls = self.class_path(owner)
        return (self._reader.member_of(cls, name) or self._reader.entry(f"{cls}.{name}")) if cls else None

    def function(self, written: str) -> str:
        """The path of a function that a message names: ``Object.ray_cast``, ``from_pydata``."""
        if "." in written:
            entry = self.member(*written.rpartition(".")[::2])
            return entry.path if entry else ""
        entries = [
            entry for entry in self._reader.names.by_name(written) if entry.kind in {"function", "operator"}
        ]
        return entries[0].path if len(entries) == 1 else ""

    def called_so(self, name: str) -> list[str]:
        """The paths of the functions of a name."""
        entries = self._reader.names.by_name(name) if name.isidentifier() else ()
        return [entry.path for entry in entries if entry.kind == "function"]

    def taking(self, function: str, argument: str) -> str:
        """The path of the one function of that name that takes an argument; empty where several do, or none."""
        symbols = filter(None, map(self._reader.symbol, self.called_so(function) if argument else ()))
        taking = [
            symbol.path for symbol in symbols if argument in {given.name for given in symbol.parameters}
        ]
        return taking[0] if len(taking) == 1 else ""
