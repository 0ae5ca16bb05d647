"""Numbers of things, and lists of some of them, as sentences have them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def counted(number: int, noun: str) -> str:
    """``1 stage``, ``2,000 stages``."""
    return f"{number:,} {noun}{'s' * (number != 1)}"


def format_list(items: Sequence[str], most: int, count: int | None = None) -> str:
    """The first ``most`` items with commas between, and how many more there are; ``count``: in all, if not all are
    listed.
    """
    left = (len(items) if count is None else count) - len(items[:most])
    return ", ".join(items[:most]) + (f" and {left} more" if left else "")
