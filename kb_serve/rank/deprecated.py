"""Puts what takes the place of a deprecated symbol before it: whoever does not name it should not use it any more."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

# As RNA says it: “Replaced by '.duration'.”
_REPLACED = re.compile(r"[Rr]eplaced by '?\.(\w+)")


def replacement(path: str, reader: BaseReader) -> str:
    """The member of the same owner that takes the place of a deprecated one; empty for others."""
    entry = reader.entry(path)
    if entry is None or entry.kind != "property" or not entry.is_deprecated:
        return ""
    symbol = reader.symbol(path)
    found = _REPLACED.search(symbol.deprecation.note) if symbol and symbol.deprecation else None
    other = f"{entry.owner}.{found[1]}" if found else ""
    return other if other and reader.entry(other) else ""
