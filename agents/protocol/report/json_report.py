"""A report as JSON: each rule with its state, and each finding."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter

from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from agents.protocol.findings import Report
    from agents.protocol.report.summary import VerificationScope
    from agents.protocol.rule import Rule

_FINDINGS = TypeAdapter(tuple[Finding, ...])


def as_json(report: Report, scope: VerificationScope) -> dict[str, Any]:
    """The report as data: each rule with its state, and each finding. Lengths in metres, angles in degrees."""
    by_rule = _by_rule(report)
    return {
        "file": scope.file,
        "scene": scope.scene,
        "frame": scope.frame,
        "blender": scope.blender,
        "plan": scope.plan,
        "ok": report.ok,
        "decided": report.decided,
        "seconds": round(report.seconds, 3),
        "rules": [
            {
                "id": rule.id,
                "name": rule.name,
                "severity": rule.severity,
                "state": _state(rule, report, by_rule.get(rule.id, [])),
                "reason": report.not_applicable.get(rule.id, ""),
                "findings": len(by_rule.get(rule.id, [])),
            }
            for rule in scope.rules
        ],
        "findings": [finite_fields(finding) for finding in report.findings],
    }


def read_findings(report: Mapping[str, Any]) -> tuple[Finding, ...]:
    """The findings of a report that ``as_json`` gave. Raises ValidationError."""
    return _FINDINGS.validate_python(report["findings"])


def finite_fields(finding: Finding) -> dict[str, Any]:
    """The fields of a finding; None for numbers that JSON cannot write."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in asdict(finding).items()
    }


def _by_rule(report: Report) -> dict[str, list[Finding]]:
    by_rule: dict[str, list[Finding]] = {}
    for finding in report.findings:
        by_rule.setdefault(finding.rule, []).append(finding)
    return by_rule


def _state(rule: Rule, report: Report, findings: Sequence[Finding]) -> str:
    """The worst outcome of a rule's findings (broken, error, undecided); else idle, or holds."""
    outcomes = {finding.outcome for finding in findings}
    worst = next((outcome for outcome in ("broken", "error", "undecided") if outcome in outcomes), None)
    return worst or ("idle" if rule.id in report.not_applicable else "holds")


def dump_json(data: dict[str, Any]) -> str:
    """JSON text that any encoding can write, whatever names are in it."""
    return json.dumps(data, ensure_ascii=False, indent=2).encode("utf-8", "backslashreplace").decode()
