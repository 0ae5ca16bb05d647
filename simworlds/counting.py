"""Numbers of things, as sentences have them."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """``1 stage``, ``2,000 stages``."""
    return f"{number:,} {noun}{'s' * (number != 1)}"
