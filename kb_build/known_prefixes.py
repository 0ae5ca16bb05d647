"""Finds which of many known texts a text begins with."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class KnownPrefixes:
    """A set of texts, each with the longest other one that it begins with."""

    def __init__(self, texts: Iterable[str]) -> None:
        self._texts = sorted(set(texts))
        self._shorter: dict[str, str | None] = {}
        open_texts: list[str] = []
        for text in self._texts:
            while open_texts and not text.startswith(open_texts[-1]):
                open_texts.pop()
            self._shorter[text] = open_texts[-1] if open_texts else None
            open_texts.append(text)

    def of(self, text: str) -> list[str]:
        """All that ``text`` begins with, the longest first."""
        found: list[str] = []
        place = bisect_right(self._texts, text)
        # What stands between a prefix and the text begins with that prefix, too.
        known = self._texts[place - 1] if place else None
        while known is not None:
            if text.startswith(known):
                found.append(known)
            known = self._shorter[known]
        return found
