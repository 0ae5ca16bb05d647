"""Calls that fill the pointers which are None on new things."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.flags import fillers

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


def calls_before(reader: BaseReader, cls: str, call: str) -> list[str]:
    """The calls after which an operator makes an instance of a class, as a scene gets a world for its rigid bodies."""
    for pointer in reader.pointing_at(cls.rpartition(".")[2]):
        symbol = reader.symbol(pointer.path)
        calls = fillers(symbol) if symbol else []
        if call in calls:
            return calls[: calls.index(call)]
    return []
