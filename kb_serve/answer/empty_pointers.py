"""Pointers on the way to a class that are None on new things."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from kb_build.symbol_lines import empty_when_new

if TYPE_CHECKING:
    from kb_build.records import Symbol
    from kb_serve.reader import BaseReader

_FEW = 8  # of all nodes and IDs each has its own pointers


def empty_pointer_to(reader: BaseReader, cls: Symbol) -> Symbol | None:
    """The last pointer on the way to instances of ``cls`` that is None on a new thing; None where there is none."""
    before, _, name = cls.reached.rpartition(".")
    if not name.isidentifier():
        return None
    for path in reader.pointers_called(name, cls.name):
        pointer = reader.symbol(path)
        owner = _reached_as(reader, pointer.owner, before) if pointer else None
        if pointer and owner:
            return pointer if empty_when_new(pointer) else empty_pointer_to(reader, owner)
    return None


def _reached_as(reader: BaseReader, cls: str, expression: str) -> Symbol | None:
    """Of a class and those below it the one whose instances an expression gives."""
    below = islice(reader.descendants(cls), _FEW)
    for path in (cls, *(entry.path for entry in below)):
        symbol = reader.symbol(path)
        if symbol and symbol.reached == expression:
            return symbol
    return None
