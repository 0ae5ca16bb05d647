"""Reports with many findings in large files."""

from __future__ import annotations

import pytest

from kb_check.command.formats.github import github_lines
from kb_check.command.formats.json_document import as_json
from kb_check.command.formats.sarif import as_sarif
from kb_check.command.formats.text import text_lines
from kb_check.command.report import FileReport, Report
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.text.source import Source

MANY = 20_000


def finding(line: int, column: int) -> Finding:
    span = Span(line, column, line, column + 1)
    return Finding("unknown-name", "error", span, "wrong", fix=Fix("Write y", (Edit(span, "y"),), sure=True))


@pytest.mark.parametrize(
    ("text", "down", "right"),
    [("x\n" * MANY, 1, 0), ("x = 1; " * MANY, 0, 7)],
    ids=["lines", "one line"],
)
def test_many_findings_are_written(text: str, down: int, right: int) -> None:
    findings = [finding(1 + down * number, right * number) for number in range(MANY)]
    # Whatever looks at a whole file or line for each of them takes minutes, and pytest ends it.
    report = Report("5.1", [FileReport("a.py", Source(text), findings)])
    assert sum(len(line) == 3 for line in text_lines(report)) >= MANY
    assert report.fixable(unsafe=False) == MANY
    assert as_json(report).count("unknown-name") == MANY
    assert as_sarif(report).count('"ruleId": "unknown-name"') == MANY
    assert len(list(github_lines(report))) == MANY


@pytest.mark.parametrize("rule", ["syntax-error", "unknown-name"])
def test_what_cannot_be_changed_is_not_counted_as_fixable(rule: str) -> None:
    broken = Finding(rule, "error", Span(1, 0, 1, 0), "wrong")
    report = Report("5.1", [FileReport("a.py", Source("x\n"), [broken, finding(1, 0)])])
    assert report.fixable(unsafe=False) == (rule == "unknown-name")
