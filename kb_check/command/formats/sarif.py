"""Findings as SARIF 2.1.0, which code hosts and editors show."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from kb_check.command.formats.json_document import dump
from kb_check.rule import all_rules
from simworlds.formats.sarif import invocations, notification, sarif_log, sarif_tool, tell_apart, uri_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_check.command.report import FileReport, Report
    from kb_check.findings import Edit, Finding, Span
    from kb_check.rule import Rule

_CONTEXT = 120  # letters on each side of a place that tell it from others


def as_sarif(*reports: Report) -> str:
    """Reports for different Blenders, each as a run; what could not be checked is a notification of it."""
    runs = [_run(report) for report in reports]
    tell_apart(runs, [f"simworlds-check/blender-{report.blender}/" for report in reports])
    return dump(sarif_log(runs))


def _run(report: Report) -> dict[str, Any]:
    rules = list(all_rules())
    files = [file for file in report.files if file.findings]
    places = {file.name: place for place, file in enumerate(files)}
    return {
        "tool": sarif_tool("simworlds check", [_rule(rule) for rule in all_rules().values()]),
        "columnKind": "unicodeCodePoints",
        "invocations": invocations([notification(fault) for fault in report.faults]),
        "artifacts": [{"location": {"uri": uri_of(file.name)}} for file in files],
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
    artifact = {"uri": uri_of(file.name), "index": place}
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
