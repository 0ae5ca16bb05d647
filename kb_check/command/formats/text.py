"""Findings for people: the place, what is wrong, the line with a marker below it, and what mends it."""

from __future__ import annotations

import unicodedata
from collections import Counter
from typing import TYPE_CHECKING

from simworlds.counting import counted
from simworlds.terminal.streams import STEERING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.command.report import FileReport, Report
    from kb_check.findings import Finding

Piece = tuple[str, str]  # text, and its style on a terminal
Line = list[Piece]

_STYLES = {"error": "bold red", "warning": "bold yellow", "note": "bold cyan"}
_WIDEST = 120  # letters of a source line
_MARGIN = 40  # of them before the marker, where the line is cut


def text_lines(report: Report) -> Iterator[Line]:
    """The findings, and a summary at the end."""
    for file in report.files:
        for finding in file.findings:
            yield from _finding(file, finding)
            yield []
    yield from _summary(report)


def place_of(file: FileReport, finding: Finding) -> str:
    """``path:line:column``, or ``path:cell 3:line:column`` in a notebook; columns count from 1."""
    return f"{line_of(file, finding)}:{finding.span.column + 1}"


def line_of(file: FileReport, finding: Finding) -> str:
    """The same without the column."""
    cell, line = file.source.place(finding.span.line)
    return f"{file.name}:{f'cell {cell}:' if cell else ''}{line}"


def _finding(file: FileReport, finding: Finding) -> Iterator[Line]:
    yield [
        (f"{place_of(file, finding)}: ", "bold"),
        (f"{finding.severity}[{finding.rule}]", _STYLES[finding.severity]),
        (f" {' '.join(finding.message.split())}", ""),
    ]
    span, lines = finding.span, file.lines
    number = str(file.source.place(span.line)[1])
    if span.line <= len(lines) and lines[span.line - 1].strip():
        text = lines[span.line - 1].rstrip("\r\n")
        end = span.end_column if span.end_line == span.line else len(text)
        shown, before, marked = _cut(text, span.column, max(end, span.column + 1))
        pad = " " * len(number)
        yield [(f"  {number} | ", "dim"), (shown, "")]
        yield [
            (f"  {pad} | ", "dim"),
            (_blank(before), ""),
            ("^" * max(_width(marked), 1), _STYLES[finding.severity]),
        ]
    if finding.fix is not None:
        option = "--fix" if finding.fix.sure else "--fix --unsafe-fixes"
        how = f" ({option})" if file.can_change else ""
        yield [("  help: ", "bold green"), (f"{finding.fix.title}{how}", "")]


def _cut(text: str, start: int, end: int) -> tuple[str, str, str]:
    """(what is shown of a line, what of it stands before the marker, what is marked)."""
    indent = len(text) - len(text.lstrip())
    first = min(indent, start)
    lead = ""
    if start - first > _WIDEST - _MARGIN:
        first, lead = start - _MARGIN, "…"
    last = first + _WIDEST
    tail = "…" if len(text) > last else ""
    # Cut first: a line may be as long as the file, and have a finding every few letters.
    shown = STEERING.sub("\N{REPLACEMENT CHARACTER}", text[first:last])
    start, end = start - first, min(end, last) - first
    return f"{lead}{shown}{tail}", lead + shown[:start], shown[start:end]


def _blank(text: str) -> str:
    """Blanks as wide as the text; tabs stay."""
    return "".join(letter if letter == "\t" else " " * _width(letter) for letter in text)


def _width(text: str) -> int:
    """How many columns of a terminal the text takes."""
    return sum(
        0 if unicodedata.combining(letter) else 2 if unicodedata.east_asian_width(letter) in "WF" else 1
        for letter in text
    )


def _summary(report: Report) -> Iterator[Line]:
    if not report.files:
        return
    checked = f"{counted(len(report.files), 'file')} checked for Blender {report.blender}"
    if report.fixed:
        yield [(f"Mended: {counted(report.fixed, 'finding')}.", "")]
    severities = Counter(finding.severity for _, finding in report.findings)
    if not severities:
        yield [(f"{checked}: nothing found.", "green")]
        return
    affected = sum(bool(file.findings) for file in report.files)
    kinds = ", ".join(counted(severities[kind], kind) for kind in _STYLES if severities[kind])
    yield [(f"{checked}: {kinds} in {counted(affected, 'file')}.", "bold")]
    sure, unsure = report.fixable(unsafe=False), report.fixable(unsafe=True)
    if sure:
        yield [(f"--fix mends {counted(sure, 'finding')}.", "")]
    if unsure:
        yield [(f"--fix --unsafe-fixes mends {counted(unsure, 'finding')}{' more' if sure else ''}.", "")]
