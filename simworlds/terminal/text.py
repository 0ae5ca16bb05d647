"""Text from models, tools and files, made safe to print."""

from __future__ import annotations

import unicodedata


def plain(text: str) -> str:
    """The text on one line, without what could steer a terminal or cannot be written as UTF-8."""
    return "".join(
        letter
        if unicodedata.category(letter)[0] != "C" or letter == "\u200d"
        else "\N{REPLACEMENT CHARACTER}"
        for letter in text
    )


def shortened(text: str, most: int) -> str:
    """The plain text on one line, cut with an ellipsis where it is longer than ``most`` letters."""
    line = plain(" ".join(text.split()))
    return line if len(line) <= most else f"{line[: most - 1].rstrip()}…"
