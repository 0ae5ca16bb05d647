"""A report as SARIF 2.1.0, for tools that show the findings of static analysis."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from agents.protocol.report.json_report import finite_fields
from simworlds.formats.sarif import invocations, notification, sarif_log, sarif_tool, uri_of
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from agents.protocol.findings import Finding, Report
    from agents.protocol.report.summary import VerificationScope
    from agents.protocol.rule import Rule

_TOOL_NAME = "simworlds verify"
_LEVELS = {"hard": "error", "soft": "warning"}


def as_sarif(report: Report, scope: VerificationScope) -> dict[str, Any]:
    """The report as SARIF. An undecided finding has the kind ``open``; a rule that failed is a notification."""
    places = {rule.id: place for place, rule in enumerate(scope.rules)}
    uri = uri_of(scope.file) if scope.file else ""
    notifications = [
        notification(plain(finding.message))
        | ({"associatedRule": {"id": finding.rule}} if finding.rule in places else {})
        for finding in report.findings
        if finding.outcome == "error"
    ]
    run = _run([_sarif_rule(rule) for rule in scope.rules], notifications) | {
        "columnKind": "unicodeCodePoints",
        "results": [
            _sarif_result(finding, places, uri) for finding in report.findings if finding.outcome != "error"
        ],
        "properties": {
            "passed": list(report.passed),
            "idle": report.not_applicable,
            "scene": scope.scene,
            "frame": scope.frame,
            "seconds": round(report.seconds, 3),
        },
    }
    if uri:
        run["artifacts"] = [{"location": {"uri": uri}}]
    return sarif_log([run])


def sarif_failure(message: str) -> dict[str, Any]:
    """SARIF of a run that failed as a whole."""
    return sarif_log([_run([], [notification(plain(message))])])


def _run(rules: list[dict[str, Any]], notifications: list[dict[str, Any]]) -> dict[str, Any]:
    """A run without results."""
    return {
        "tool": sarif_tool(_TOOL_NAME, rules),
        "invocations": invocations(notifications),
        "results": [],
    }


def _sarif_rule(rule: Rule) -> dict[str, Any]:
    return {
        "id": rule.id,
        "name": rule.name,
        "shortDescription": {"text": rule.about},
        "fullDescription": {"text": f"{rule.about} {rule.why}"},
        "help": {"text": rule.fix},
        "defaultConfiguration": {"level": _LEVELS[rule.severity]},
    }


def _sarif_result(finding: Finding, places: dict[str, int], uri: str) -> dict[str, Any]:
    is_open = finding.outcome == "undecided"
    text = f"{finding.message} {finding.fix}".strip()
    same = json.dumps([finding.rule, finding.objects, finding.outcome])
    location: dict[str, Any] = {
        "logicalLocations": [{"name": plain(name), "kind": "object"} for name in finding.objects]
    }
    if uri:
        location["physicalLocation"] = {"artifactLocation": {"uri": uri, "index": 0}}
    return {
        "ruleId": finding.rule,
        **({"ruleIndex": places[finding.rule]} if finding.rule in places else {}),
        "kind": "open" if is_open else "fail",
        "level": "none" if is_open else _LEVELS[finding.severity],
        "message": {"text": plain(text)},
        "locations": [location] if finding.objects or uri else [],
        "partialFingerprints": {"ruleAndObjects/v1": hashlib.sha256(same.encode()).hexdigest()},
        "properties": {
            name: value
            for name, value in finite_fields(finding).items()
            if name in {"measured", "tolerance", "unit", "frame", "at"} and value not in {None, ""}
        },
    }
