"""Findings as workflow commands of GitHub Actions, which shows them beside the changed lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.command.report import FileReport, Report
    from kb_check.findings import Finding

_COMMANDS = {"error": "error", "warning": "warning", "note": "notice"}


def github_lines(report: Report) -> Iterator[str]:
    """One command for each finding."""
    for file, finding in report.findings:
        yield _command(file, finding)
    for fault in report.faults:
        yield f"::error title=simworlds check::{_escaped(fault)}"


def _command(file: FileReport, finding: Finding) -> str:
    span = finding.span
    cell, line = file.source.place(span.line)
    # The lines of a notebook's file are not those of its cells.
    where = {} if cell else {"line": line, "endLine": span.end_line, "col": span.column + 1}
    if not cell and span.line == span.end_line:  # elsewhere columns are not allowed
        where["endColumn"] = max(span.end_column, span.column + 1)
    elif not cell:
        del where["col"]
    fields = {"file": file.name, **where, "title": finding.rule}
    properties = ",".join(f"{key}={_property(str(value))}" for key, value in fields.items())
    lead = f"cell {cell}, line {line}: " if cell else ""
    return f"::{_COMMANDS[finding.severity]} {properties}::{_escaped(lead + finding.message)}"


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _escaped(text).replace(":", "%3A").replace(",", "%2C")
