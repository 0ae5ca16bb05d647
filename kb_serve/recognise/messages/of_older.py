"""Says that a message is an older Blender's: it lacks what came later."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.paths import as_code

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

_FEW = 2


def of_older(path: str, reader: BaseReader) -> str:
    """A sentence on a symbol that this Blender has and that of a message lacks: since when, and what older ones have in
    its place. Empty for what is as old as the history.
    """
    version, lacked = reader.history.arrival(path)
    before = [
        old for old in reader.history.replaced_by(path) if (span := reader.history.removed(old)) and span[2]
    ]
    if not version and not before:
        return ""
    since = f", since {version}{' or a little before' if lacked else ''}" if version else ""
    there = " or ".join(f"`{as_code(old)}`" for old in before[:_FEW])
    instead = f" There, use {there}." if there else ""
    here = f"Blender {reader.meta.get('minor', '')} has `{as_code(path)}`{since}"
    return f"{here}: the message is an older one's.{instead}"
