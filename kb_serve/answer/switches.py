"""Switches and what they switch on, by their names: ``use_constant_offset`` and ``constant_offset_displace``,
``operand_type='COLLECTION'`` and ``collection``.

The panels of modifiers and constraints are not written in Python, so that nothing is known of them but the names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbol_lines import usual_default

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.records import Symbol
    from kb_serve.reader import BaseReader, SymbolEntry

_SWITCH = "use_"
_MOST = 6
_LEAST_CHOICES = 2


def switch_lines(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """What goes with a switch, and what switches a property on, where the names alone tell it."""
    if symbol.kind != "property" or reader.panel_tests(symbol.path):
        return
    names = reader.members(symbol.owner)
    yield from _chosen_by(symbol, names, reader)
    if not symbol.name.startswith(_SWITCH):
        parts = symbol.name.split("_")
        stems = ("_".join(parts[:count]) for count in range(len(parts), 0, -1))
        switch = next((name for stem in stems if (name := _SWITCH + stem) in names), "")
        if switch:
            found = reader.symbol(names[switch].path)
            off = " (a new one has it off)" if found and usual_default(found) is False else ""
            yield f"goes with `{switch}`{off}"
    elif symbol.type == "boolean":
        stem = symbol.name.removeprefix(_SWITCH)
        alike = [name for name in names if name == stem or name.startswith(f"{stem}_")]
        if alike:
            more = f" and {len(alike) - _MOST} more" if len(alike) > _MOST else ""
            yield f"goes with {', '.join(f'`{name}`' for name in alike[:_MOST])}{more}"


def _chosen_by(symbol: Symbol, names: Mapping[str, SymbolEntry], reader: BaseReader) -> Iterator[str]:
    """The enumeration beside a property that chooses between it and others: its values are called as they are."""
    for entry in names.values():
        if entry.type != "enum" or entry.name == symbol.name:
            continue
        found = reader.symbol(entry.path)
        values = [item.identifier for item in found.enum_items] if found else []
        named = [value for value in values if value.lower() in names]
        if symbol.name.upper() in named and len(named) >= max(_LEAST_CHOICES, len(values) - 1):
            has = f" (a new one has `{usual_default(found)!r}`)" if found and usual_default(found) else ""
            yield f"goes with `{entry.name} = {symbol.name.upper()!r}`{has}"
