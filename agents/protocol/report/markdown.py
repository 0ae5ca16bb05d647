"""A report as Markdown for a model: a line per group of findings, each with its fix."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.report.grouping import group_findings
from agents.protocol.report.summary import coverage, fix_of, is_untagged, verdict
from agents.protocol.report.text_format import format_value
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from agents.protocol.findings import Finding, Report
    from agents.protocol.report.grouping import FindingGroup
    from agents.protocol.report.summary import VerificationScope

_MAX_OBJECTS = 10  # of a group
_UNTAGGED = (
    "Most rules need the protocol's tags, and this scene has none: tag its objects first (blender_group)."
)
_OUTCOMES = {"broken": "", "undecided": ", undecided", "error": ", the rule failed"}


def as_text(report: Report, scope: VerificationScope) -> str:
    """The verdict, a line per group of findings with its fix, and what was checked."""
    names = {rule.id: rule.name for rule in scope.rules}
    lines = [verdict(report)]
    before = ""
    for group in group_findings(report.findings):
        worst, count = group.worst, len(group.findings)
        title = f"{worst.rule} {names.get(worst.rule, '')}".strip()
        times = f", {count} times" if count > 1 else ""
        lines.append(f"- **{title}** ({worst.severity}{_OUTCOMES[worst.outcome]}){times}: {group.message}")
        if count > 1 and not group.differ:
            objects = group.objects(_MAX_OBJECTS).replace("\n", "; ")
            lines[-1] += f" Objects: {objects}." if objects else ""
        values = ", ".join(_values(group))
        lines[-1] += f" [{values}]" if values else ""
        if group.differ:
            lines += [f"  - {plain(_each(finding))}" for finding in group.findings[:_MAX_OBJECTS]]
            if count > _MAX_OBJECTS:
                lines.append(f"  - … and {count - _MAX_OBJECTS} more")
        fix = fix_of(group, scope)
        if fix and fix != before:
            lines.append(f"  Fix: {fix}")
        before = fix
    advice = [_UNTAGGED] if is_untagged(report) else []
    return "\n".join([*lines, "", *coverage(report, scope), *advice])


def _values(group: FindingGroup) -> list[str]:
    """What was measured, the tolerance, and the frame, as far as the findings have them."""
    frames = {finding.frame for finding in group.findings}
    frame = frames.pop() if len(frames) == 1 else None
    values = {
        "measured": group.measured,
        "tolerance": group.tolerance,
        "frame": "" if frame is None else str(frame),
    }
    return [f"{label} {value}" for label, value in values.items() if value]


def _each(finding: Finding) -> str:
    """One finding of a group with different fixes: its objects, the measured value, its fix."""
    measured = "" if finding.measured is None else f" {format_value(finding.measured, finding.unit)}"
    return f"{' · '.join(finding.objects)}:{measured} → {finding.fix}"
