"""Says on one line what a class has as many members: those whose names are the letters of others, ``zyx``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.reader import SymbolEntry

_MANY = 8


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
