"""How steps write the members of classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbol_lines import SET
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader, SymbolEntry

UNSEEN = "(RNA's)"  # in the line of a setting of which no instance could be made
_MOST_SETTINGS = 10
_NONE = " = None"
_PLAIN = ("name", "index")  # every thing has them


def settings_of(cls: str, reader: BaseReader) -> str:
    """The heaviest settings of a class, each with its default and first values; empty for a class without any.

    What is given to it, a data-block where a new one has none, counts as a setting.
    """
    entries = [
        entry
        for entry in reader.members(cls).values()
        if entry.kind == "property"
        and entry.name not in _PLAIN
        and (_is_given(entry, reader) or entry.type not in {"pointer", "collection"})
        and not (entry.is_read_only or entry.is_deprecated)
    ]
    return ", ".join(_short(entry) for entry in reader.heaviest(entries)[:_MOST_SETTINGS])


def _is_given(entry: SymbolEntry, reader: BaseReader) -> bool:
    """Whether a property takes a data-block, and has none on a new instance."""
    is_empty = entry.type == "pointer" and entry.head.endswith(_NONE)
    return is_empty and reader.descends(f"{TYPES}{entry.target}", f"{TYPES}ID")


def call_of(function: SymbolEntry) -> str:
    """A call as it can be written: without ``self``, and without the marks of how arguments are given."""
    call = function.line.partition("`")[2].partition("`")[0]
    return call.replace("(self, ", "(").replace("*, ", "").replace(", /", "")


def _short(entry: SymbolEntry) -> str:
    """A property with its default and its first values, without its type: ``quality` = 5``; of a pointer its target."""
    if entry.type == "pointer":
        return f"`{entry.name}`{_NONE} ({entry.target})"
    name, _, rest = entry.head.partition(" ")
    rest = rest.removeprefix(SET).removeprefix(entry.type).strip()
    return f"{name} {rest.partition('] ')[2] if rest.startswith('[') else rest}".strip()
