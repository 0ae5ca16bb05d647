"""Says on one line what a class has as many members: those whose names are the letters of others, ``zyx``; and of one
of these what its name tells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_MANY = 8
_FEWEST = 2  # parts of a vector


def without_swizzles(members: Sequence[SymbolEntry]) -> tuple[list[SymbolEntry], str]:
    """The members without those of a vector that put its parts together, and the line for these; "" for none."""
    letters = [entry.name for entry in members if len(entry.name) == 1]
    swizzles = [entry for entry in members if len(entry.name) > 1 and set(entry.name) <= {*letters}]
    if len(swizzles) < _MANY:
        return list(members), ""
    left_out = {entry.path for entry in swizzles}
    kept = [entry for entry in members if entry.path not in left_out]
    longest = max(len(entry.name) for entry in swizzles)
    first, last = letters[0], "".join(reversed(letters[: longest - 1]))
    parts = ", ".join(f"`{letter}`" for letter in letters)
    line = (
        f"- `{last}`, `{first * 2}` and so on, {len(swizzles)} in all: {parts} put together in any order, two to "
        f"{longest} of them, as a new {swizzles[0].type}"
    )
    return kept, line


def swizzle_text(symbol: Symbol, reader: BaseReader) -> str:
    """What a member that puts parts of a vector together asks of it, by its name; empty for other members."""
    if symbol.kind != "property" or len(symbol.name) < 2 or symbol.type != symbol.owner.rpartition(".")[2]:
        return ""
    letters = [name for name in reader.members(symbol.owner) if len(name) == 1]
    if not set(symbol.name) <= {*letters}:
        return ""
    least = max(_FEWEST, 1 + max(map(letters.index, symbol.name)))
    twice = next((letter for letter in symbol.name if symbol.name.count(letter) > 1), "")
    can_be_set = f"read-only, `{twice}` is in it more than once" if twice else "can be assigned"
    return f"of a vector with {least} parts{' or more' if least < len(letters) else ''} · {can_be_set}"
