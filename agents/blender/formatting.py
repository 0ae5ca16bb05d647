"""Counts, lists and sizes as replies to models write them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def format_list(items: Sequence[str], most: int, count: int | None = None) -> str:
    """The first ``most`` items with commas between, and how many more there are; ``count``: in all, if not all are
    listed.
    """
    left = (len(items) if count is None else count) - len(items[:most])
    return ", ".join(items[:most]) + (f" and {left} more" if left else "")


def format_size(count: float) -> str:
    """Bytes in decimal units: ``512 bytes``, ``1.5 MB``."""
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "bytes" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"
