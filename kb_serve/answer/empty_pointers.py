"""Pointers on the way to a class that are None on new things."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbol_lines import empty_when_new

if TYPE_CHECKING:
    from kb_build.records import Symbol
    from kb_serve.reader import BaseReader


def empty_pointer_to(reader: BaseReader, cls: Symbol) -> Symbol | None:
    """The pointer that leads to instances of ``cls`` and is None on a new thing; None where there is none."""
    before, _, name = cls.reached.rpartition(".")
    if not name.isidentifier():
        return None
    for path in reader.pointers_called(name, cls.name):
        pointer = reader.symbol(path)
        owner = reader.symbol(pointer.owner) if pointer else None
        if pointer and owner and owner.reached == before and empty_when_new(pointer):
            return pointer
    return None
