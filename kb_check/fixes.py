"""Applies the fixes of findings to text and to files."""

from __future__ import annotations

import difflib
import shutil
from bisect import bisect_left, insort
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_check.salvage import parses
from kb_check.source import Source, split_lines
from simworlds.files import staged_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from kb_check.findings import Edit, Finding, Span


@dataclass(frozen=True, slots=True)
class Fixed:
    """A text after its fixes, and how many there were."""

    text: str
    count: int


def is_fixable(finding: Finding, *, unsafe: bool) -> bool:
    """Whether a finding has a fix that is to be applied: a sure one, or any."""
    return finding.fix is not None and (finding.fix.sure or unsafe)


def apply_fixes(source: Source, findings: Iterable[Finding], *, unsafe: bool = False) -> Fixed:
    """Applies fixes in order; one that overlaps an earlier one is left for the next round.

    Nothing is changed in a notebook, in what could not be read, and where the result would not parse.
    """
    text = source.text
    if source.cells or source.fault:
        return Fixed(text, 0)
    offsets = _Offsets(text)
    newline = "\r\n" if "\r\n" in text[: text.find("\n") + 1] else "\n"
    chosen: list[tuple[int, int, str]] = []
    count = 0
    for finding in findings:
        if finding.fix is None or not is_fixable(finding, unsafe=unsafe):
            continue
        edits = [offsets.replacement(edit, newline) for edit in finding.fix.edits]
        if edits and not any(_overlaps(edit, chosen) for edit in edits):
            for edit in edits:
                insort(chosen, edit)
            count += 1
    if not chosen:
        return Fixed(text, 0)
    changed = "".join(_replaced(text, chosen))
    return Fixed(changed, count) if changed != text and parses(changed) else Fixed(text, 0)


def write_fixed(path: Path, before: bytes, after: bytes) -> None:
    """Writes a file whole, with its permissions. Raises OSError, also when it is not any more what it was."""
    real = path.resolve()
    if real.read_bytes() != before:
        raise OSError(f"{path} was changed meanwhile")
    with staged_file(real) as part:
        part.write_bytes(after)
        shutil.copymode(real, part)


def unified_diff(name: str, before: str, after: str) -> str:
    """The changes of one file, as ``diff -u`` writes them."""
    lines = difflib.unified_diff(split_lines(before), split_lines(after), name, name)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )


class _Offsets:
    def __init__(self, text: str) -> None:
        self._starts = [0]
        for line in split_lines(text):
            self._starts.append(self._starts[-1] + len(line))

    def replacement(self, edit: Edit, newline: str) -> tuple[int, int, str]:
        start, end = self._range(edit.span)
        return start, end, edit.text.replace("\n", newline)

    def _range(self, span: Span) -> tuple[int, int]:
        return self._at(span.line, span.column), self._at(span.end_line, span.end_column)

    def _at(self, line: int, column: int) -> int:
        if line > len(self._starts):
            return self._starts[-1]
        return min(self._starts[line - 1] + column, self._starts[-1])


def _overlaps(edit: tuple[int, int, str], chosen: list[tuple[int, int, str]]) -> bool:
    """Whether an edit touches what one of the chosen replaces; they are sorted, and apart."""
    start, end, _ = edit
    place = bisect_left(chosen, edit)
    return any(
        (start, end) == other[:2] or (start < other[1] and other[0] < end)
        for other in chosen[max(place - 1, 0) : place + 1]
    )


def _replaced(text: str, edits: list[tuple[int, int, str]]) -> Iterator[str]:
    place = 0
    for start, end, new in edits:
        yield text[place:start]
        yield new
        place = end
    yield text[place:]
