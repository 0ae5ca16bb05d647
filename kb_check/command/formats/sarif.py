"""Findings as SARIF 2.1.0, which code hosts and editors show."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from kb_check.command.formats.json_document import dump
from kb_check.rule import all_rules

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_check.command.report import FileReport, Report
    from kb_check.findings import Edit, Finding, Span
    from kb_check.rule import Rule

_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_CONTEXT = 120  # letters on each side of a place that tell it from others


def as_sarif(*reports: Report) -> str:
    """Reports for different Blenders, each as a run; what could not be checked is a notification of it.

    Code hosts take several runs of one tool only if each says which it is.
    """
    runs = [_run(report) for report in reports]
    if len(runs) > 1:
        for run, report in zip(runs, reports, strict=True):
            run["automationDetails"] = {"id": f"simworlds-check/blender-{report.blender}/"}
    return dump({"$schema": _SCHEMA, "version": "2.1.0", "runs": runs})


def _run(report: Report) -> dict[str, Any]:
    rules = list(all_rules())
    files = [file for file in report.files if file.findings]
    places = {file.name: place for place, file in enumerate(files)}
    return {
        "tool": {"driver": {"name": "simworlds check", "rules": [_rule(rule) for rule in all_rules().values()]}},
        "columnKind": "unicodeCodePoints",
        "invocations": [
            {
                "executionSuccessful": not report.faults,
                "toolExecutionNotifications": [
                    {"level": "error", "message": {"text": fault}} for fault in report.faults
                ],
            }
        ],
        "artifacts": [{"location": {"uri": _uri(file.name)}} for file in files],
        "results": [
            _result(file, places[file.name], finding, rules) for file, finding in report.findings
        ],
        "properties": {"blender": report.blender, "files": len(report.files)},
    }  # fmt: skip


def _rule(rule: Rule) -> dict[str, Any]:
    return {
        "id": rule.id,
        "shortDescription": {"text": rule.title},
        "help": {"text": rule.page, "markdown": rule.page},
        "defaultConfiguration": {"level": rule.severity},
    }


def _result(file: FileReport, place: int, finding: Finding, rules: list[str]) -> dict[str, Any]:
    cell, line = file.source.place(finding.span.line)
    artifact = {"uri": _uri(file.name), "index": place}
    physical: dict[str, Any] = {"artifactLocation": artifact}
    if not cell:  # the lines of a notebook's file are not those of its cells
        physical["region"] = _region(finding.span)
    same = f"{finding.rule}\0{finding.symbol or finding.message}\0{_context(file, finding.span)}"
    result: dict[str, Any] = {
        "ruleId": finding.rule,
        "ruleIndex": rules.index(finding.rule),
        "level": finding.severity,
        "message": {"text": (f"cell {cell}, line {line}: " if cell else "") + finding.message},
        "locations": [{"physicalLocation": physical}],
        "partialFingerprints": {
            "ruleSymbolLine/v1": hashlib.sha256(same.encode(errors="replace")).hexdigest()
        },
    }
    if finding.fix is not None and not cell:
        result["fixes"] = [_fix(artifact, finding.fix.title, finding.fix.edits)]
    return result


def _fix(artifact: dict[str, Any], title: str, edits: Iterable[Edit]) -> dict[str, Any]:
    replacements = [
        {"deletedRegion": _region(edit.span), "insertedContent": {"text": edit.text}} for edit in edits
    ]
    return {
        "description": {"text": title},
        "artifactChanges": [{"artifactLocation": artifact, "replacements": replacements}],
    }


def _region(span: Span) -> dict[str, int]:
    return {
        "startLine": span.line,
        "startColumn": span.column + 1,
        "endLine": span.end_line,
        "endColumn": span.end_column + 1,
    }


def _context(file: FileReport, span: Span) -> str:
    """The text around the beginning of a span, on its line."""
    if span.line > len(file.lines):
        return ""
    return file.lines[span.line - 1][max(span.column - _CONTEXT, 0) : span.column + _CONTEXT].strip()


def _uri(name: str) -> str:
    """A relative path stays relative; an absolute one becomes a URI with a scheme."""
    path = Path(name)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix(), errors="replace")
