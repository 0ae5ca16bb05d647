"""Findings that a file had before it was edited: they are not the edit's, unless it makes them worse."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from agents.loop.task import Finding
    from agents.loop.tool_client import ToolOutcome

_SLACK = 0.01  # of what was measured before, by which it may be worse: measuring is not exact
_LEAST = 1e-4
_GROUNDED = "W1"  # its findings name what floats, and what of all that this touches lacks a contact
_OUTCOMES = ("undecided", "error", "broken")  # from what is least known to be wrong


def new_findings(known: Iterable[Finding], findings: Sequence[Finding]) -> list[Finding]:
    """Those ``findings`` that were not ``known``, or are worse than they were; of the latter, the message says so.

    What stands on something that already lacked a connection to the ground is not new.
    """
    before: dict[tuple[Any, ...], list[Finding]] = defaultdict(list)
    floating: set[str] = set()
    for finding in known:
        before[_about(finding)].append(finding)
        floating.update(finding["objects"][:1] if finding["rule"] == _GROUNDED else ())
    found: dict[int, Finding] = {}
    for place in sorted(range(len(findings)), key=lambda place: -_badness(findings[place])):
        finding = findings[place]
        if finding["rule"] == _GROUNDED and finding["objects"][1:] and finding["objects"][-1] in floating:
            continue  # it touches what the file itself did not connect to the ground
        same = before[_about(finding)]
        as_bad = [one for one in same if _is_no_worse(finding, one)]
        if as_bad:
            same.remove(min(as_bad, key=_badness))
        elif same:
            found[place] = {**finding, "message": _worse_message(finding, max(same, key=_badness))}
        else:
            found[place] = finding
    return [found[place] for place in sorted(found)]


def told_since(known: Sequence[Finding], outcome: ToolOutcome) -> tuple[list[Finding], str]:
    """The findings of a call of the verifier that were not ``known``, and what models are told of it."""
    findings = new_findings(known, outcome.data["findings"])
    return findings, format_new(findings) if known else outcome.text


def format_new(findings: Sequence[Finding]) -> str:
    """Findings that were not there before, for models."""
    if not findings:
        return "No findings that were not there before the edit."
    return "\n".join(
        f"- {one['rule']} ({one['severity']}) {', '.join(one['objects'])}: {one['message']} {one['fix']}".rstrip()
        for one in findings
    )


def _about(finding: Mapping[str, Any]) -> tuple[Any, ...]:
    return (finding["rule"], *sorted(finding.get("objects", ())))  # which comes first may depend on sizes


def _badness(finding: Finding) -> float:
    """How far what was measured is from what is allowed; 0 where nothing was measured."""
    measured, tolerance = finding.get("measured"), finding.get("tolerance")
    return 0.0 if measured is None else abs(measured - (tolerance or 0.0))


def _is_no_worse(now: Finding, before: Finding) -> bool:
    if now["severity"] == "hard" and before["severity"] != "hard":
        return False
    if _OUTCOMES.index(now["outcome"]) > _OUTCOMES.index(before["outcome"]):
        return False
    if now.get("measured") is None or before.get("measured") is None:
        return True
    return _badness(now) <= _badness(before) * (1 + _SLACK) + _LEAST


def _worse_message(now: Finding, before: Finding) -> str:
    if now.get("measured") is None or before.get("measured") is None:
        return f"{now['message']} Before the edit: {before['message']}"
    unit = f" {now['unit']}" if now.get("unit") else ""
    return f"{now['message']} The edit made this worse: it was {before['measured']:.4g}{unit}."
