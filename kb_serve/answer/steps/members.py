"""How steps write the members of classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader, SymbolEntry

_MOST_SETTINGS = 10
_PLAIN = ("name", "index")  # every thing has them


def settings_of(cls: str, reader: BaseReader) -> str:
    """The heaviest settings of a class, each with its default and first values; empty for a class without any."""
    entries = [
        entry
        for entry in reader.members(cls).values()
        if entry.kind == "property"
        and entry.type not in {"pointer", "collection"}
        and entry.name not in _PLAIN
        and can_be_set(entry)
    ]
    return ", ".join(_short(entry) for entry in reader.heaviest(entries)[:_MOST_SETTINGS])


def can_be_set(entry: SymbolEntry) -> bool:
    """Whether a property can be assigned."""
    return "read-only" not in entry.line.partition(" — ")[0]


def call_of(function: SymbolEntry) -> str:
    """A call as it can be written: without ``self``, and without the marks of how arguments are given."""
    call = function.line.partition("`")[2].partition("`")[0]
    return call.replace("(self, ", "(").replace("*, ", "").replace(", /", "")


def _short(entry: SymbolEntry) -> str:
    """A property with its default and its first values, without its type: ``quality` = 5``."""
    name, _, rest = entry.line.partition(" — ")[0].partition(" ")
    rest = rest.removeprefix(entry.type).strip()
    return f"{name} {rest.partition('] ')[2] if rest.startswith('[') else rest}".strip()
