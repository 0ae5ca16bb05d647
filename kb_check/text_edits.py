"""A script's text while it is edited: every line remembers the line of the original that it came from."""

from __future__ import annotations

from bisect import bisect_left, insort
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

from kb_check.source import split_lines

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_check.findings import Edit, Span


@dataclass(frozen=True)
class Text:
    """Text, and for each of its lines the number of the line in the original."""

    code: str
    origins: tuple[int, ...] = field(default=())

    @classmethod
    def original(cls, code: str) -> Text:
        """A text that nobody has edited."""
        return cls(code, tuple(range(1, len(split_lines(code)) + 2)))

    @cached_property
    def _lines(self) -> list[str]:
        return split_lines(self.code)

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *accumulate(map(len, self._lines))]

    def lines(self, first: int, last: int) -> str:
        """The text of some lines, by their numbers."""
        return "".join(self._lines[first - 1 : last])

    def origin(self, line: int) -> int:
        """The line of the original that a line came from."""
        return self.origins[min(line, len(self.origins)) - 1] if self.origins else line

    def offsets(self, span: Span) -> tuple[int, int]:
        """Where a span begins and ends, in characters from the start."""
        last = len(self._starts) - 1
        start = self._starts[min(span.line - 1, last)] + span.column
        return start, self._starts[min(span.end_line - 1, last)] + span.end_column

    def part(self, span: Span) -> str:
        """The text of a span."""
        start, end = self.offsets(span)
        return self.code[start:end]

    def edited(self, edits: Iterable[Edit]) -> Text:
        """The text after edits that do not overlap."""
        parts: list[str] = []
        origins: list[int] = []
        at, line = 0, 0  # what of the old text, and of its lines, is in the new one
        for edit in sorted(edits, key=lambda one: self.offsets(one.span)):
            start, end = self.offsets(edit.span)
            parts += (self.code[at:start], edit.text)
            first, last = edit.span.line - 1, edit.span.end_line - 1
            origins += self.origins[line:first]
            # Its first line is still to come: another edit may follow on the last line.
            origins += (self.origins[min(first + number, last)] for number in range(edit.text.count("\n")))
            at, line = end, max(last, line)
        return Text("".join([*parts, self.code[at:]]), (*origins, *self.origins[line:]))


class Taken:
    """The parts of a text that edits have taken. Two that begin at one place collide, whatever their length."""

    def __init__(self) -> None:
        self._spans: list[tuple[int, int]] = []

    def is_free(self, span: tuple[int, int]) -> bool:
        """Whether nothing of a span, given by its offsets, is taken."""
        at = bisect_left(self._spans, span)
        return not any(
            span[0] == other[0] or (span[0] < other[1] and other[0] < span[1])
            for other in self._spans[max(at - 1, 0) : at + 1]
        )

    def add(self, span: tuple[int, int]) -> None:
        """Takes a span."""
        insort(self._spans, span)
