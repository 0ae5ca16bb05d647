"""Findings for programs, as one JSON document; docs/check.md describes it."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kb_check.command.report import FileReport, Report
    from kb_check.findings import Finding, Fix, Span
    from kb_check.text.source import Source

FORMAT = 1


def as_json(report: Report) -> str:
    """The report. Lines and columns count from 1, and an end is the first place behind."""
    severities = Counter(finding.severity for _, finding in report.findings)
    document: dict[str, Any] = {
        "format": FORMAT,
        "blender": report.blender,
        "files": len(report.files),
        "fixed": report.fixed,
        "errors": severities["error"],
        "warnings": severities["warning"],
        "notes": severities["note"],
        "unchecked": report.faults,
        "findings": [_finding(file, finding) for file, finding in report.findings],
    }
    return dump(document)


def dump(document: dict[str, Any]) -> str:
    """JSON that any reader takes: halves of characters are replaced."""
    text = json.dumps(document, ensure_ascii=False, indent=2)
    return text.encode("utf-8", "replace").decode()


def _finding(file: FileReport, finding: Finding) -> dict[str, Any]:
    return {
        "path": file.name,
        **span_as_json(file.source, finding.span),
        "rule": finding.rule,
        "severity": finding.severity,
        "message": finding.message,
        "symbol": finding.symbol,
        "instead": list(finding.instead),
        "fix": _fix(file.source, finding.fix) if finding.fix else None,
    }


def _fix(source: Source, fix: Fix) -> dict[str, Any]:
    return {
        "title": fix.title,
        "sure": fix.sure,
        "edits": [{**span_as_json(source, edit.span), "text": edit.text} for edit in fix.edits],
    }


def span_as_json(source: Source, span: Span) -> dict[str, int]:
    """Where something stands, in the source's own cells and lines; an end is the first place behind."""
    cell, line = source.place(span.line)
    return {
        **({"cell": cell} if cell else {}),
        "line": line,
        "column": span.column + 1,
        "end_line": source.place(span.end_line)[1],
        "end_column": span.end_column + 1,
    }
