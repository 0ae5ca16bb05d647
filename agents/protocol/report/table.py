"""A report as a table for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from agents.protocol.report.grouping import group_findings
from agents.protocol.report.summary import coverage, exit_code, fix_of, is_untagged, verdict, without_tags
from agents.protocol.report.text_format import MAX_NAMES
from simworlds.operating_system import SYSTEM
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import RenderableType

    from agents.protocol.findings import Report
    from agents.protocol.report.grouping import FindingGroup
    from agents.protocol.report.summary import VerificationScope

_COLOURS = {"hard": "red", "soft": "yellow"}
_NARROW = 100  # letters


def as_table(report: Report, scope: VerificationScope, width: int) -> Group:
    """A table with a row per group of findings, and what was checked, for rich to print ``width`` letters wide."""
    parts: list[RenderableType] = [Text(scope.title, "bold")]
    if is_untagged(report):
        parts += map(Text, _untagged(report, scope))
    groups = group_findings(report.findings)
    if groups:
        parts.append(_table(groups, scope, is_narrow=width < _NARROW))
    parts.append(Text(verdict(report), "bold red" if exit_code(report) else "bold green"))
    parts += [Text(line, "dim") for line in coverage(report, scope)]
    parts.append(Text(f"measured in {report.seconds:.1f} s, not counting the opening of the file", "dim"))
    return Group(*parts)


def _untagged(report: Report, scope: VerificationScope) -> list[str]:
    """By what a scene without tags is judged, and what it can be checked for."""
    rules = without_tags(report, scope)
    text = (
        "Judged by SimWorlds' scene protocol, of whose tags this scene has none. They say which meshes are one object "
        "and what it stands on: without them, gaps and missing support are not checked, and the findings of family C "
        "say only that tags are missing. An agent sets them, with the tools of simworlds mcp."
    )
    if rules:
        names = ", ".join(f"{rule.name} ({rule.id})" for rule in rules)
        file = SYSTEM.quoted(scope.file) if scope.file else "FILE"
        command = f"simworlds verify {file} --rules {','.join(rule.id for rule in rules)}"
        return [text, plain(f"What needs no tags: {names}. Check for that alone: {command}")]
    return [text]


def _table(groups: Sequence[FindingGroup], scope: VerificationScope, *, is_narrow: bool) -> Table:
    """``is_narrow``: objects and tolerances have no columns of their own."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("Rule")
    if not is_narrow:
        table.add_column("Objects", overflow="fold", max_width=38)
    table.add_column("Measured", justify="right")
    if not is_narrow:
        table.add_column("Tolerance", justify="right")
    table.add_column("Finding and fix", overflow="fold")
    names = {rule.id: rule.name for rule in scope.rules}
    before = ""
    for group in groups:
        fix = fix_of(group, scope)
        message = _message_cell(group, "" if fix == before else fix)
        before = fix
        rule, objects, measured = _rule_cell(group, names), Text(group.objects()), Text(group.measured)
        if is_narrow:
            measured.append(f"\nof {group.tolerance}" if group.tolerance else "", "dim")
            table.add_row(rule, measured, Text("\n").join([objects, message]), end_section=True)
        else:
            table.add_row(rule, objects, measured, Text(group.tolerance), message, end_section=True)
    return table


def _rule_cell(group: FindingGroup, names: dict[str, str]) -> Text:
    worst, count = group.worst, len(group.findings)
    cell = Text(worst.rule, f"bold {_COLOURS[worst.severity]}")
    cell.append(f"\n{names.get(worst.rule, '')}", "not bold")
    state = {"broken": worst.severity, "undecided": "undecided", "error": "failed"}[worst.outcome]
    cell.append(f"\n{state}" + (f" ×{count}" if count > 1 else ""), "not bold dim")
    return cell


def _message_cell(group: FindingGroup, fix: str) -> Text:
    cell = Text(group.message)
    if fix:
        cell.append(f"\n→ {plain(fix)}", "italic")
    if group.differ and len(group.findings) <= MAX_NAMES:
        cell.append("".join(f"\n· {plain(finding.fix)}" for finding in group.findings), "italic")
    return cell
