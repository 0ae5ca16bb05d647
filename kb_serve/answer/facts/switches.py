"""Switches and what they switch on, by their names: ``use_constant_offset`` and ``constant_offset_displace``,
``operand_type='COLLECTION'`` and ``collection``.

The panels of modifiers and constraints are not written in Python, so that nothing is known of them but the names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.flags import usual_default

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

_SWITCH = "use_"
_MOST = 6
_LEAST_CHOICES = 2


def switch_lines(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """What goes with a switch, and what switches a property on: for those of which panels tell nothing."""
    if symbol.kind != "property":
        return
    yield from _chosen_by(symbol, reader)
    if not symbol.name.startswith(_SWITCH):
        yield from _switched_by(symbol, reader)
    elif symbol.type == "boolean":
        alike = reader.members_called(symbol.owner, symbol.name.removeprefix(_SWITCH))
        if alike:
            more = f" and {len(alike) - _MOST} more" if len(alike) > _MOST else ""
            yield f"goes with {', '.join(f'`{name}`' for name in alike[:_MOST])}{more}"


def _switched_by(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """The switch that has the beginning of a property's name."""
    parts = symbol.name.split("_")
    stems = ["_".join(parts[:count]) for count in range(len(parts), 0, -1)]
    paths = [f"{symbol.owner}.{_SWITCH}{stem}" for stem in stems]
    reader.entry.load(paths)
    path = next((path for path in paths if reader.entry(path)), "")
    if switch := reader.symbol(path) if path else None:
        off = " (a new one has it off)" if usual_default(switch) is False else ""
        yield f"goes with `{switch.name}`{off}"


def _chosen_by(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """The enumeration beside a property that chooses between it and others: its values are called as they are."""
    for path, value, _ in reader.names.enum_owners(key(symbol.name)):
        enum = reader.symbol(path) if path.rpartition(".")[0] == symbol.owner else None
        if enum is None or value != symbol.name.upper() or enum.name == symbol.name:
            continue
        values = [item.identifier for item in enum.enum_items]
        paths = [f"{symbol.owner}.{item.lower()}" for item in values]
        reader.entry.load(paths)
        named = sum(reader.entry(path) is not None for path in paths)
        if named >= max(_LEAST_CHOICES, len(values) - 1):
            has = f" (a new one has `{usual_default(enum)!r}`)" if usual_default(enum) else ""
            yield f"goes with `{enum.name} = {value!r}`{has}"
