"""Findings that a file had before it was edited: they are not the edit's, unless it makes them worse."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from agents.protocol.report.grouping import group_findings
from agents.protocol.report.json_report import read_findings

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from agents.loop.running.tool_client import ToolOutcome
    from agents.protocol.findings import Finding
    from agents.protocol.report.grouping import FindingGroup

_MAX_NAMED = 30  # objects of a line
_SLACK = 0.01  # of what was measured before, by which it may be worse: measuring is not exact
_LEAST = 1e-4
_GROUNDED = "W1"  # its findings name what floats, and what of all that this touches lacks a contact
_OUTCOMES = ("undecided", "error", "broken")  # from what is least known to be wrong


def new_findings(known: Iterable[Finding], findings: Sequence[Finding]) -> list[Finding]:
    """Those ``findings`` that were not ``known``, or are worse than they were; of the latter, the message says so.

    What stands on something that already lacked a connection to the ground is not new.
    """
    before: dict[tuple[str, ...], list[Finding]] = defaultdict(list)
    floating: set[str] = set()
    for finding in known:
        before[_about(finding)].append(finding)
        floating.update(finding.objects[:1] if finding.rule == _GROUNDED else ())
    found: dict[int, Finding] = {}
    for place in sorted(range(len(findings)), key=lambda place: -_badness(findings[place])):
        finding = findings[place]
        if finding.rule == _GROUNDED and finding.objects[1:] and finding.objects[-1] in floating:
            continue  # it touches what the file itself did not connect to the ground
        same = before[_about(finding)]
        as_bad = [fault for fault in same if _is_no_worse(finding, fault)]
        if as_bad:
            same.remove(min(as_bad, key=_badness))
        elif same:
            found[place] = replace(finding, message=_worse_message(finding, max(same, key=_badness)))
        else:
            found[place] = finding
    return [found[place] for place in sorted(found)]


def told_since(
    known: Sequence[Finding], outcome: ToolOutcome, off_plan: Sequence[Finding] = ()
) -> tuple[list[Finding], str]:
    """The findings of a call of the verifier that were not ``known``, behind those that the plan of an edit adds, and
    what models are told of both.
    """
    findings = new_findings(known, read_findings(outcome.data))
    text = format_new(findings) if known else outcome.text
    return ([*off_plan, *findings], f"{format_new(off_plan)}\n{text}") if off_plan else (findings, text)


def format_known(findings: Iterable[Finding]) -> list[str]:
    """Findings that a file has before it is edited, for models: those that say the same in one line."""
    return [_known_line(group) for group in group_findings(findings)]


def _known_line(group: FindingGroup) -> str:
    rule, count = group.worst.rule, len(group.findings)
    if count == 1:
        return f"{rule} {', '.join(group.worst.objects)}: {group.worst.message}"
    objects = group.objects(_MAX_NAMED).replace("\n", "; ")
    return f"{rule}, {count} times: {group.message}{f' Objects: {objects}.' if objects else ''}"


def format_new(findings: Sequence[Finding]) -> str:
    """Findings that were not there before, for models."""
    if not findings:
        return "No findings that were not there before the edit."
    return "\n".join(
        f"- {new.rule} ({new.severity}) {', '.join(new.objects)}: {new.message} {new.fix}".rstrip()
        for new in findings
    )


def _about(finding: Finding) -> tuple[str, ...]:
    return (finding.rule, *sorted(finding.objects))  # which comes first may depend on sizes


def _badness(finding: Finding) -> float:
    """How far what was measured is from what is allowed; 0 where nothing was measured."""
    return 0.0 if finding.measured is None else abs(finding.measured - (finding.tolerance or 0.0))


def _is_no_worse(now: Finding, before: Finding) -> bool:
    if now.severity == "hard" and before.severity != "hard":
        return False
    if _OUTCOMES.index(now.outcome) > _OUTCOMES.index(before.outcome):
        return False
    if now.measured is None or before.measured is None:
        return True
    return _badness(now) <= _badness(before) * (1 + _SLACK) + _LEAST


def _worse_message(now: Finding, before: Finding) -> str:
    if now.measured is None or before.measured is None:
        return f"{now.message} Before the edit: {before.message}"
    unit = f" {now.unit}" if now.unit else ""
    return f"{now.message} The edit made this worse: it was {before.measured:.4g}{unit}."
