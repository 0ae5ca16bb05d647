"""Pointers and collections on the way to a class that are None, or empty, on new things."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.records import EMPTY
from kb_build.symbol_lines import empty_when_new, fillers

if TYPE_CHECKING:
    from kb_build.records import Symbol
    from kb_serve.reader import BaseReader

_FEW = 8  # of all nodes and IDs each has its own pointers
_WAY = re.compile(r"(?P<before>.+)\.(?P<name>\w+)(?P<key>\[[^\]]+\])?")
_FIRST = (None, "[0]")  # of a collection whose elements have no names; who asks for a name has made it
_FAR = 3  # dots of what leads through another pointer than those to what is always there: ``bpy.context.scene.world``


def empty_pointer_to(reader: BaseReader, cls: Symbol) -> Symbol | None:
    """What on the way to instances of ``cls`` is None on a new thing, or the last collection, of which the first
    element is taken, that is empty there; None where there is none.
    """
    way = _WAY.fullmatch(cls.reached)
    if way is None:
        return None
    before, name, key = way.groups()
    if key not in _FIRST and before.count(".") < _FAR:
        return None
    pointers = [
        pointer
        for base in reader.lineage(cls.path)
        for path in reader.pointers_called(name, base.name)
        if (pointer := reader.symbol(path))
    ]
    for pointer in pointers:
        owner = reader.symbol(pointer.owner)
        if owner and owner.reached == before:
            is_empty = key in _FIRST and (empty_when_new(pointer) or EMPTY in pointer.flags)
            return pointer if is_empty else empty_pointer_to(reader, owner)
    if before.count(".") >= _FAR and len(pointers) == 1:
        owner = _below(reader, pointers[0].owner, before)
        return empty_pointer_to(reader, owner) if owner else None
    return None


def calls_before(reader: BaseReader, cls: str, call: str) -> list[str]:
    """The calls after which an operator makes an instance of a class, as a scene gets a world for its rigid bodies."""
    for pointer in reader.pointing_at(cls.rpartition(".")[2]):
        symbol = reader.symbol(pointer.path)
        calls = fillers(symbol) if symbol else []
        if call in calls:
            return calls[: calls.index(call)]
    return []


def _below(reader: BaseReader, cls: str, expression: str) -> Symbol | None:
    """Of the first few classes below a class the one whose instances an expression gives."""
    for entry in islice(reader.descendants(cls), _FEW):
        symbol = reader.symbol(entry.path)
        if symbol and symbol.reached == expression:
            return symbol
    return None
