"""A script's text while it is edited: every line remembers the line of the original that it came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
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
    def _starts(self) -> list[int]:
        starts, at = [0], 0
        for line in split_lines(self.code):
            at += len(line)
            starts.append(at)
        return starts

    def lines(self, first: int, last: int) -> str:
        """The text of some lines, by their numbers."""
        return "".join(split_lines(self.code)[first - 1 : last])

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
        code, origins = self.code, list(self.origins)
        for edit in sorted(edits, key=lambda one: (one.span.line, one.span.column), reverse=True):
            start, end = self.offsets(edit.span)
            code = code[:start] + edit.text + code[end:]
            first, before = edit.span.line - 1, edit.span.end_line - edit.span.line
            old = origins[first : first + before + 1]
            added = edit.text.count("\n")
            origins[first : first + before + 1] = [old[min(line, before)] for line in range(added + 1)]
        return Text(code, tuple(origins))


def overlap(first: Span, second: Span) -> bool:
    """Whether two spans share text; equal places without length count as shared."""
    one = (first.line, first.column), (first.end_line, first.end_column)
    two = (second.line, second.column), (second.end_line, second.end_column)
    return one == two or (one[0] < two[1] and two[0] < one[1])
