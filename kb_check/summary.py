"""Findings as text for a language model, within a number of tokens: errors first, equal ones together."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from kb_check.text.source import split_lines
from kb_serve.answer.budget import clip, tokens
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_check.findings import Finding, Fix

_ORDER = ("error", "warning", "note")
_FOR_MORE = 40  # tokens of the line about what did not fit
_LONGEST_FIX = 400  # characters
_MOST_LINES = 8  # that are named of equal findings


def ranked(findings: Sequence[Finding]) -> list[Finding]:
    """The findings, errors first, each severity in the script's order."""
    return sorted(findings, key=lambda finding: _ORDER.index(finding.severity))


def mended(lines: Sequence[str], fix: Fix | None) -> str:
    """The lines that a fix changes as they are then, without their common indentation; "" without a fix."""
    if fix is None or not fix.edits:
        return ""
    first = min(edit.span.line for edit in fix.edits)
    last = max(edit.span.end_line for edit in fix.edits)
    text = "".join(lines[first - 1 : last])
    starts = [0]
    for line in lines[first - 1 : last]:
        starts.append(starts[-1] + len(line))
    for edit in sorted(fix.edits, key=lambda edit: (edit.span.line, edit.span.column), reverse=True):
        begin = starts[edit.span.line - first] + edit.span.column
        end = starts[edit.span.end_line - first] + edit.span.end_column
        text = text[:begin] + edit.text + text[end:]
    text = textwrap.dedent(text).strip("\r\n")
    return text if len(text) <= _LONGEST_FIX else ""


def summarize(findings: Sequence[Finding], code: str, blender: str, max_tokens: int) -> str:
    """What was found in a script, checked for a Blender. What does not fit is counted at the end."""
    lines = split_lines(code)
    size = counted(len(lines), "line")
    if not findings:
        return f"Nothing found: {size} checked for Blender {blender} (names, keywords, values, sockets)."
    counts = (counted(sum(f.severity == kind for f in findings), kind) for kind in _ORDER)
    parts = [f"{', '.join(count for count in counts if count[:2] != '0 ')} in {size}, for Blender {blender}."]
    groups = _grouped(findings)
    room = max_tokens - tokens(parts[0])
    shown = 0
    told: set[str] = set()
    for number, group in enumerate(groups):
        part = _group_text(group, lines, told)
        is_last = number == len(groups) - 1
        if number == 0:
            part = clip(part, room - _FOR_MORE)
        if tokens(part) + 1 > room - (0 if is_last else _FOR_MORE):
            break
        parts.append(part)
        room -= tokens(part) + 1
        shown += len(group)
    if left := len(findings) - shown:
        parts.append(f"{left} more: mend these first, or call again with a larger max_tokens.")
    return "\n\n".join(parts)


def _grouped(findings: Sequence[Finding]) -> list[list[Finding]]:
    groups: dict[tuple[str, str, str], list[Finding]] = {}
    for finding in ranked(findings):
        groups.setdefault((finding.severity, finding.rule, finding.message), []).append(finding)
    return list(groups.values())


def _group_text(group: Sequence[Finding], lines: Sequence[str], told: set[str]) -> str:
    """What is said of equal findings. ``told`` are the fixes that were shown before: one may mend several things."""
    first = group[0]
    numbers = list(dict.fromkeys(finding.span.line for finding in group))
    named = ", ".join(map(str, numbers[:_MOST_LINES])) + (", …" if len(numbers) > _MOST_LINES else "")
    text = f"line{'s' if len(numbers) > 1 else ''} {named}: {first.severity} [{first.rule}] {first.message}"
    if first.fix is None or not (right := mended(lines, first.fix)):
        return text
    label = "fix" if first.fix.sure else "perhaps"
    if len(numbers) > 1:
        label += f" (line {numbers[0]})"
    if right in told:
        return f"{text}\n{label}: as above"
    told.add(right)
    return f"{text}\n{label}: {_as_code(right)}"


def _as_code(text: str) -> str:
    return f"`{text}`" if "\n" not in text and "`" not in text else f"\n```python\n{text}\n```"
