"""Sizes as replies to models write them."""

from __future__ import annotations


def format_size(count: float) -> str:
    """Bytes in decimal units: ``512 bytes``, ``1.5 MB``."""
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "bytes" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"
