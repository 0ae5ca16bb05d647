"""Comments that ignore findings."""

from __future__ import annotations

import pytest

from kb_check.findings import Finding, Span
from kb_check.text.fixes import apply_fixes
from kb_check.text.ignores import Ignores
from kb_check.text.source import Source

RULES = ("a", "b", "c")


def on(line: int, rule: str = "a", end: int = 0) -> Finding:
    return Finding(rule, "error", Span(line, 0, end or line, 1), "wrong")


@pytest.mark.parametrize(
    ("code", "kept"),
    [
        ("x  # simworlds: ignore\ny", [2]),
        ("x  # simworlds: ignore[a]\ny", [2]),
        ("x  # simworlds:ignore[b, a]\ny", [2]),
        ("x  # simworlds: ignore[b]\ny", [1, 2]),
        ("x  # simworlds: ignore[]\ny", [1, 2]),
        ("x  # noqa: E1  # simworlds: ignore[a]\ny", [2]),
        ("x  # simworlds: ignored\ny", [1, 2]),
        ("x = '# simworlds: ignore'\ny", [1, 2]),
        ("'''\n# simworlds: ignore'''\ny", [1, 2]),
        ("# simworlds: ignore-file\ny", []),
        ("#\n# simworlds: ignore-file[a]", []),
        ("\n" * 9 + "# simworlds: ignore-file[a]", []),
        ("\n" * 10 + "# simworlds: ignore-file[a]", [1, 2]),
        ("x = (  # simworlds: ignore[a]\n", [2]),  # that Python cannot read it does not matter
    ],
)
def test_a_comment_ignores_what_it_names(code: str, kept: list[int]) -> None:
    found = Ignores(code).kept([on(1), on(2)])
    assert [finding.span.line for finding in found] == kept


def test_any_line_of_a_finding_may_have_the_comment() -> None:
    assert not Ignores("f(\n1,  # simworlds: ignore[a]\n)").kept([on(1, end=3)])


@pytest.mark.parametrize(
    ("code", "message", "mended"),
    [
        ("x  # simworlds: ignore[b]\n", "is not found here: b.", "x\n"),
        ("x  # simworlds: ignore[zz]\n", "There is no rule zz", "x\n"),
        ("x  # simworlds: ignore[]\n", "nothing to ignore.", "x\n"),
        ("x  # simworlds: ignore[a, b]\n", "is not found here: b.", "x  # simworlds: ignore[a]\n"),
        ("x  # simworlds: ignore[b]  # noqa\n", "is not found here: b.", "x    # noqa\n"),
        ("x\n\n# simworlds: ignore", "nothing to ignore.", "x\n\n"),
        ("# simworlds: ignore-file[c]\nx\n", "is not found here: c.", "\nx\n"),
    ],
)
def test_a_comment_that_ignores_nothing_is_a_note_with_a_fix(code: str, message: str, mended: str) -> None:
    ignores = Ignores(code)
    ignores.kept([on(1)])
    (note,) = ignores.unused(RULES)
    assert note.severity == "note"
    assert message in note.message
    assert apply_fixes(Source(code), [note]).text == mended


def test_a_comment_that_was_needed_is_no_note() -> None:
    ignores = Ignores("x  # simworlds: ignore[a]\ny  # simworlds: ignore\n")
    assert not ignores.kept([on(1), on(2)])
    assert not list(ignores.unused(RULES))


def test_that_note_can_be_ignored_by_name_alone() -> None:
    for comment, count in (("ignore[b, unused-ignore]", 0), ("ignore", 1)):
        ignores = Ignores(f"x  # simworlds: {comment}\n")
        assert len(ignores.kept(list(ignores.unused(RULES)))) == count
