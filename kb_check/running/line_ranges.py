"""Ranges of lines, and whether a line is in one of them."""

from __future__ import annotations

from bisect import bisect_right
from operator import itemgetter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class LineRanges:
    """Ranges of lines, given by the first and the last line of each."""

    def __init__(self, ranges: Iterable[tuple[int, int]]) -> None:
        self._outer: list[tuple[int, int]] = []  # in order, without those that lie in others
        for first, last in sorted(ranges):
            if not self._outer or last > self._outer[-1][1]:
                self._outer.append((first, last))

    def __contains__(self, line: int) -> bool:
        place = bisect_right(self._outer, line, key=itemgetter(0)) - 1
        return place >= 0 and line <= self._outer[place][1]
