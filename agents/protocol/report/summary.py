"""A report in brief: its verdict, the exit code, what was checked, and labels for pictures."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from agents.protocol.report.text_format import format_rule_ids, format_value
from agents.protocol.rule import NO_PLAN, NO_ROLES
from simworlds.counting import counted
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from agents.protocol.findings import Finding, Report
    from agents.protocol.report.grouping import FindingGroup
    from agents.protocol.rule import Rule

_TOLD = frozenset({NO_ROLES, NO_PLAN})
_LAYOUT = "C"  # the family of rules about the tags themselves


@dataclass(frozen=True, slots=True)
class VerificationScope:
    """What was verified, and by which rules. ``file`` is as the caller named it, "" for the open scene."""

    rules: tuple[Rule, ...]
    file: str = ""
    scene: str = ""
    frame: int | None = None
    blender: str = ""
    plan: str = ""

    @property
    def title(self) -> str:
        """The scope in words."""
        parts = [Path(self.file).name or self.scene or "the open scene"]
        if self.frame is not None:
            parts.append(f"frame {self.frame}")
        if self.plan:
            parts.append(f"plan {self.plan!r}")
        return ", ".join(map(plain, parts))


def exit_code(report: Report) -> int:
    """1: a hard rule is broken; 2: none is, but not every rule could be decided; 0: otherwise."""
    if any(finding.severity == "hard" and finding.outcome == "broken" for finding in report.findings):
        return 1
    return 0 if report.decided else 2


def verdict(report: Report) -> str:
    """The outcome in one sentence."""
    counts = Counter((finding.severity, finding.outcome) for finding in report.findings)
    broken = {
        finding.rule
        for finding in report.findings
        if (finding.severity, finding.outcome) == ("hard", "broken")
    }
    hard, soft = counts["hard", "broken"], counts["soft", "broken"]
    undecided = sum(count for (_, outcome), count in counts.items() if outcome != "broken")
    words = [
        f"{counted(hard, 'hard finding')} of {counted(len(broken), 'rule')}" if hard else "no hard finding"
    ]
    words += [counted(soft, "soft finding")] * bool(soft)
    words += [f"{undecided} could not be decided"] * bool(undecided)
    state = "Not ok" if hard else "Ok" if report.decided else "Undecided"
    return f"{state}: {', '.join(words)}."


def is_untagged(report: Report) -> bool:
    """Whether the scene has none of the protocol's tags, which most rules need."""
    return NO_ROLES in report.not_applicable.values()


def without_tags(report: Report, scope: VerificationScope) -> list[Rule]:
    """The rules that could be applied to a scene without tags, but for those about the tags themselves."""
    return [
        rule
        for rule in scope.rules
        if rule.id not in report.not_applicable and not rule.id.startswith(_LAYOUT)
    ]


def coverage(report: Report, scope: VerificationScope) -> list[str]:
    """Lines that say what was checked, and what was not and why."""
    order = [rule.id for rule in scope.rules]
    broken = {finding.rule for finding in report.findings if finding.outcome == "broken"}
    undecided = {finding.rule for finding in report.findings if finding.outcome != "broken"}
    judged = [
        name
        for name in order
        if name not in report.not_applicable and (name in broken or name not in undecided)
    ]
    lines = [f"Checked: {format_rule_ids(judged, order) or 'nothing'}."]
    if passed := [name for name in order if name in report.passed]:
        lines.append(f"Passed: {format_rule_ids(passed, order)}.")
    if undecided_ids := [name for name in order if name in undecided]:
        lines.append(f"Undecided, at least in part: {format_rule_ids(undecided_ids, order)}.")
    reasons: dict[str, list[str]] = {}
    for name in order:
        if name in report.not_applicable:
            reasons.setdefault(report.not_applicable[name], []).append(name)
    lines += _not_checked(reasons, order)
    return [*lines, *map(plain, report.remarks)]


def _not_checked(reasons: dict[str, list[str]], order: list[str]) -> list[str]:
    """One line: only reasons that the reader can do something about are spelt out."""
    told = {why: names for why, names in reasons.items() if why in _TOLD}
    idle = [name for why, names in reasons.items() if why not in _TOLD for name in names]
    parts = [f"{format_rule_ids(names, order)} ({plain(why)})" for why, names in told.items()]
    parts += [f"{format_rule_ids(idle, order)} (nothing to judge)"] if idle else []
    return [f"Not checked: {'; '.join(parts)}."] if parts else []


def fix_of(group: FindingGroup, scope: VerificationScope) -> str:
    """The fix that a group's findings share, or the rule's where they differ."""
    if not group.differ:
        return group.worst.fix
    return next((rule.fix for rule in scope.rules if rule.id == group.worst.rule), "")


def short_label(finding: Finding) -> str:
    """A label for a finding in a picture: the rule and the measured value."""
    measured = (
        "" if finding.measured is None or not finding.unit else format_value(finding.measured, finding.unit)
    )
    return f"{finding.rule} {measured}".strip()
