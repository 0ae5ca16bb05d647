"""What statements are once all their sure fixes are made, again until nothing changes: what answers show as a fix.

A fix mends one thing. What else is wrong in its statement, or shows only then, would still fail:
``bpy.ops.export_mesh.stl(use_selection=True)`` has another name now, and under that name another keyword.
"""

from __future__ import annotations

import ast
import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.text.edits import Text
from kb_check.text.fixes import after_fixes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_check.checker import Checker, Read

_MOST_ROUNDS = 5
_LONGEST = 20_000  # characters of code that is checked again


def with_whole_fixes(checker: Checker, read: Read, findings: Sequence[Finding]) -> list[Finding]:
    """The findings with fixes that mend all of their statements that can surely be mended."""
    if read.error is not None or not any(finding.fix and finding.fix.sure for finding in findings):
        return list(findings)
    last = _Mended(Text.original(read.code), findings)
    for _ in range(_MOST_ROUNDS if len(read.code) <= _LONGEST else 1):
        text = after_fixes(last.text, [one.fix for one in last.findings if one.fix and one.fix.sure]).text
        if text.code == last.text.code:
            break
        last = _Mended(text, checker.check(text.code) if len(read.code) <= _LONGEST else ())
    statements = _statements(read.tree)
    return [_with_whole_fix(finding, read.code, last, statements) for finding in findings]


@dataclass(frozen=True, slots=True)
class _Mended:
    """A text after rounds of sure fixes, and what is found in it."""

    text: Text
    findings: Sequence[Finding]

    def lines(self, first: int, last: int) -> str:
        """What became of some lines of the original."""
        return _lines_from(self.text, first, last)

    def fix_of(self, finding: Finding, first: int, last: int) -> Fix | None:
        """The fix that a finding in some lines of the original has now."""
        found = (
            other.fix
            for other in self.findings
            if (other.rule, other.message) == (finding.rule, finding.message)
            and first <= self.text.origin(other.span.line) <= last
        )
        return next(found, None)


def _lines_from(text: Text, first: int, last: int) -> str:
    at = [now for now, origin in enumerate(text.origins, 1) if first <= origin <= last]
    return text.lines(at[0], at[-1]) if at else ""


def _statements(tree: ast.Module) -> list[tuple[int, int]]:
    """The lines of the statements that hold no others, in order."""
    return sorted(
        (node.lineno, node.end_lineno or node.lineno)
        for node in walk(tree)
        if isinstance(node, ast.stmt) and not hasattr(node, "body")
    )


def _with_whole_fix(
    finding: Finding, code: str, mended: _Mended, statements: Sequence[tuple[int, int]]
) -> Finding:
    if finding.fix is None or not finding.fix.edits:
        return finding
    first = min(edit.span.line for edit in finding.fix.edits)
    last = max(edit.span.end_line for edit in finding.fix.edits)
    at = bisect_right(statements, (first, math.inf)) - 1
    if at >= 0 and statements[at][1] >= first:
        first, last = min(first, statements[at][0]), max(last, statements[at][1])
    original = Text.original(code)
    before, after = original.lines(first, last), mended.lines(first, last)
    if not finding.fix.sure and after not in ("", before):
        fix = mended.fix_of(finding, first, last)
        after = _lines_from(mended.text.edited(fix.edits), first, last) if fix else ""
    if after in ("", before):
        after = _lines_from(original.edited(finding.fix.edits), first, last)
    whole = Span(first, 0, last, len(original.lines(last, last).rstrip("\r\n")))
    edits = (Edit(whole, after.rstrip("\r\n")),)
    return replace(finding, fix=replace(finding.fix, edits=edits))
