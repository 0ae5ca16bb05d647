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
    symbol = reader.symbol(path) if path in reader.names.deprecated_properties else None
    found = _REPLACED.search(symbol.deprecation.note) if symbol and symbol.deprecation else None
    other = f"{symbol.owner}.{found[1]}" if symbol and found else ""
    return other if other and reader.entry(other) else ""
