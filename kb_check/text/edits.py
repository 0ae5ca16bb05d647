"""Text that is edited: which edits can be made together, and which line of the original each line came from."""

from __future__ import annotations

from bisect import bisect_left, insort
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING, TypeVar

from kb_check.text.source import split_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kb_check.findings import Edit, Span

_T = TypeVar("_T")
_MOST_TRIALS = 60  # to find the edits that leave a text which cannot be read


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

    def now(self, line: int) -> int:
        """The line that a line of the original is now; where it is gone, the one that stands in its place."""
        return next((now for now, origin in enumerate(self.origins, 1) if origin >= line), line)

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


def largest(items: Sequence[_T], holds: Callable[[Sequence[_T]], bool]) -> list[_T]:
    """Items for which a condition holds together: all of them, or without those that break it."""
    trials = _MOST_TRIALS

    def among(some: Sequence[_T]) -> list[_T]:
        nonlocal trials
        trials -= 1
        if trials < 0 or not some:
            return []
        if holds(some):
            return list(some)
        if len(some) == 1:
            return []
        halves = [*among(some[: len(some) // 2]), *among(some[len(some) // 2 :])]
        return halves if holds(halves) else []

    return among(items)


def apart(text: Text, items: Iterable[_T], edits: Callable[[_T], Sequence[Edit]]) -> Iterator[_T]:
    """The items whose edits share no text with those of an item before; ``edits`` are an item's, at least one.

    Two edits that begin at one place share it, whatever their length.
    """
    taken: list[tuple[int, int]] = []
    for item in items:
        spans = [text.offsets(edit.span) for edit in edits(item)]
        if spans and not any(_meets(span, taken) for span in spans):
            for span in spans:
                insort(taken, span)
            yield item


def _meets(span: tuple[int, int], taken: list[tuple[int, int]]) -> bool:
    """Whether a span touches one of those that are taken; they are sorted."""
    at = bisect_left(taken, span)
    return any(
        span[0] == other[0] or (span[0] < other[1] and other[0] < span[1])
        for other in taken[max(at - 1, 0) : at + 1]
    )
