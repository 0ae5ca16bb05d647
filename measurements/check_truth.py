"""Measures the checker against what Blender says to scripts that a language model wrote from memory."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_check.checker import Checker
from kb_check.command.run import MOST_ROUNDS
from kb_check.text.edits import Text, apart
from kb_check.text.fixes import is_fixable
from measurements.report import ReportPart, TargetFigure
from measurements.scripts.truth import FOLDER, SETS, Truth, read_truth, run
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_check.findings import Finding
    from measurements.setting import Setting

_HEADER = ("scripts", "errors of the API", "found", "findings", "right", "not executed", "sure fixes", "run")


@dataclass(slots=True)
class Counts:
    """Of one set. ``wrong`` and ``missed`` are places: script, line, and what was said."""

    errors: int = 0
    found: int = 0
    right: int = 0
    unjudged: int = 0
    fixes: int = 0
    fixed: int = 0
    wrong: list[str] = field(default_factory=list[str])
    missed: list[str] = field(default_factory=list[str])

    @property
    def findings(self) -> int:
        """Those that could be judged."""
        return self.right + len(self.wrong)


class Statements:
    """The statements of a script by line: a compound one has only its header's lines."""

    def __init__(self, code: str) -> None:
        self._first: dict[int, int] = {}
        for node in ast.walk(ast.parse(code)):
            if not isinstance(node, ast.stmt):
                continue
            inner: list[ast.stmt] = getattr(node, "body", [])
            last = inner[0].lineno - 1 if inner else node.end_lineno or node.lineno
            for line in range(node.lineno, max(last, node.lineno) + 1):
                self._first[line] = max(node.lineno, self._first.get(line, 0))

    def first_line(self, line: int) -> int:
        """The first line of the innermost statement at a line."""
        return self._first.get(line, line)


def judge(counts: Counts, name: str, code: str, findings: Iterable[Finding], truth: Truth) -> None:
    """Compares the findings in one script with what Blender said."""
    statements = Statements(code)
    by_line: dict[int, list[str]] = {}
    for finding in findings:
        by_line.setdefault(statements.first_line(finding.span.line), []).append(
            f"[{finding.rule}] {finding.message}"
        )
    failed = {statements.first_line(error.line) for error in truth.errors}
    told: set[int] = set()
    for error in truth.errors:
        line = statements.first_line(error.line)
        if error.kind != "api" or line in told:
            continue
        told.add(line)
        counts.errors += 1
        if line in by_line:
            counts.found += 1
        else:
            counts.missed.append(f"{name}:{error.line} {error.type}: {error.message}")
    for line, messages in by_line.items():
        for message in messages:
            if line in failed:
                counts.right += 1
            elif line in truth.ran:
                counts.wrong.append(f"{name}:{line} {message}")
            else:
                counts.unjudged += 1


def mend(checker: Checker, code: str) -> tuple[Text, list[int]]:
    """A script after its sure fixes, round by round as ``--fix`` applies them, and the line of each as it then is."""
    text, mended = Text.original(code), list[int]()
    for _ in range(MOST_ROUNDS):
        sure = [finding for finding in checker.check(text.code) if is_fixable(finding, unsafe=False)]
        chosen = list(apart(text, sure, lambda finding: finding.fix.edits if finding.fix else ()))
        if not chosen:
            break
        mended += [text.origin(finding.span.line) for finding in chosen]
        text = text.edited(edit for finding in chosen if finding.fix for edit in finding.fix.edits)
    now = {origin: line for line, origin in reversed([*enumerate(text.origins, 1)])}
    return text, [now[line] for line in mended]


def judge_fixes(counts: Counts, name: str, code: str, checker: Checker) -> None:
    """Applies the sure fixes of a script and runs it: whether the statements that were mended run.

    A statement in which the checker then still finds an error is no proof of either.
    """
    text, mended = mend(checker, code)
    if not mended:
        return
    truth, statements = run(text.code, name), Statements(text.code)
    failed = {statements.first_line(error.line) for error in truth.errors if error.kind == "api"}
    left = {
        statements.first_line(finding.span.line)
        for finding in checker.check(text.code)
        if finding.severity == "error"
    }
    for line in map(statements.first_line, mended):
        if line not in left and (line in truth.ran or line in failed):
            counts.fixes += 1
            counts.fixed += line not in failed


def compare(setting: Setting, *, fixes: bool) -> dict[str, Counts]:
    """Set → counts. ``fixes``: run what the sure fixes make, which takes a Blender for each script."""
    truths = read_truth()
    found = {name: Counts() for name in SETS}
    with Checker(setting.base) as checker:
        for name, truth in truths.items():
            code = (FOLDER / name).read_text(encoding="utf-8")
            findings = checker.check(code)
            counts = found[name.partition("/")[0]]
            judge(counts, name, code, [each for each in findings if each.severity == "error"], truth)
            if fixes:
                judge_fixes(counts, name, code, checker)
    return found


def measure(setting: Setting) -> ReportPart:
    """Checks every script and compares; ``quick`` runs no mended scripts."""
    say("check_truth: scripts as language models write them")
    found = compare(setting, fixes=not setting.quick)
    rows = tuple(
        (
            name, f"{each.errors}", f"{each.found}", f"{each.findings}", f"{each.right}", f"{each.unjudged}",
            f"{each.fixes}", f"{each.fixed}",
        )
        for name, each in found.items()
    )  # fmt: skip
    figures: list[TargetFigure] = []
    for name, each in found.items():
        suffix = "" if name == "unseen" else f"_{name}"
        figures.append(
            TargetFigure(f"check_found{suffix}", each.found / max(1, each.errors), f"{each.errors} errors")
        )
        figures.append(
            TargetFigure(
                f"check_right{suffix}", each.right / max(1, each.findings), f"{each.findings} findings"
            )
        )
    fixes = sum(each.fixes for each in found.values())
    if fixes:
        fixed = sum(each.fixed for each in found.values())
        figures.append(TargetFigure("check_fixes", fixed / fixes, f"{fixes} sure fixes, executed"))
    seen = found["seen"]
    data = {"missed": seen.missed, "wrong": seen.wrong}
    return ReportPart(
        "check_truth",
        tuple(figures),
        (Table("Scripts from memory, and what Blender says to them", _HEADER, rows),),
        (),
        data,
    )
