"""Fixes applied to text and files."""

from __future__ import annotations

import shutil
import stat
import subprocess
from typing import TYPE_CHECKING

import pytest

from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.text.fixes import apply_fixes, unified_diff, write_fixed
from kb_check.text.source import Cell, Source

if TYPE_CHECKING:
    from pathlib import Path


def replacing(*parts: tuple[int, int, int, str], sure: bool = True) -> Finding:
    """A finding whose fix replaces (line, first column, end column) by a text."""
    edits = tuple(Edit(Span(line, start, line, end), text) for line, start, end, text in parts)
    return Finding("a", "error", edits[0].span, "wrong", fix=Fix("Write it", edits, sure=sure))


def test_fixes_are_applied_where_they_stand() -> None:
    source = Source("é = 1\r\nb = é\r\n")
    fixed = apply_fixes(source, [replacing((2, 4, 5, "cc")), replacing((1, 4, 5, "22"))])
    assert (fixed.text, fixed.count) == ("é = 22\r\nb = cc\r\n", 2)


def test_the_first_of_two_that_overlap_wins() -> None:
    fixed = apply_fixes(
        Source("abcdef\n"), [replacing((1, 0, 3, "x")), replacing((1, 2, 4, "y")), replacing((1, 3, 6, "z"))]
    )
    assert (fixed.text, fixed.count) == ("xz\n", 2)


def test_a_fix_is_applied_whole_or_not_at_all() -> None:
    several = replacing((1, 0, 1, "x"), (2, 0, 1, "y"))
    fixed = apply_fixes(Source("a\nb\n"), [replacing((2, 0, 1, "c")), several])
    assert (fixed.text, fixed.count) == ("a\nc\n", 1)


def test_insertions_at_one_place_are_not_mixed() -> None:
    fixed = apply_fixes(Source("x\n"), [replacing((1, 0, 0, "a")), replacing((1, 0, 0, "b"))])
    assert (fixed.text, fixed.count) == ("ax\n", 1)


def test_new_lines_are_those_of_the_file() -> None:
    assert apply_fixes(Source("x\r\n"), [replacing((1, 0, 1, "a\nb"))]).text == "a\r\nb\r\n"


def test_only_sure_fixes_unless_others_are_wanted() -> None:
    unsure = replacing((1, 0, 1, "a"), sure=False)
    assert apply_fixes(Source("x\n"), [unsure]).count == 0
    assert apply_fixes(Source("x\n"), [unsure], unsafe=True).text == "a\n"


@pytest.mark.parametrize(
    "source",
    [
        Source("x\n", cells=(Cell(1, 1),)),
        Source("x\n", fault="the encoding is unknown"),
        Source("x\ny z\n"),
    ],
)
def test_what_cannot_be_read_or_written_is_left(source: Source) -> None:
    assert apply_fixes(source, [replacing((1, 0, 1, "a"))]).text == source.text


def test_what_would_not_parse_is_not_written() -> None:
    assert apply_fixes(Source("x\n"), [replacing((1, 0, 1, "a b"))]) == apply_fixes(Source("x\n"), [])


def test_a_fix_that_would_not_parse_takes_no_other_with_it() -> None:
    fixed = apply_fixes(Source("x\ny\n"), [replacing((1, 0, 1, "a b")), replacing((2, 0, 1, "z"))])
    assert (fixed.text, fixed.count) == ("x\nz\n", 1)


def test_many_fixes_take_no_more_than_their_share() -> None:
    source = Source("x\n" * 20_000)
    fixed = apply_fixes(source, [replacing((line, 0, 1, "y")) for line in range(1, 20_001)])
    assert fixed.text == "y\n" * 20_000


@pytest.mark.parametrize("tool", [["patch", "-p0"], ["git", "apply", "-p0"]], ids=["patch", "git"])
@pytest.mark.parametrize("name", ["a.py", "a b.py", "é.py", 'q"\tb\\s\n.py'])
@pytest.mark.parametrize(
    "code", ["{}\ny", "{}\r\ny\r\n", "\ufeff{}\ny\n", "x\x0c\x85\u2028\r\n{}\n", "x\r{}\r\n", "\x1b[31m{}\n"]
)
def test_a_diff_can_be_applied(tmp_path: Path, code: str, name: str, tool: list[str]) -> None:
    if shutil.which(tool[0]) is None:
        pytest.skip(f"{tool[0]} is not installed")
    before, after = code.format("1").encode(), code.format("2").encode()
    (tmp_path / name).write_bytes(before)
    subprocess.run(tool, input=unified_diff(name, before, after), cwd=tmp_path, check=True)
    assert (tmp_path / name).read_bytes() == after


def test_permissions_and_links_stay(tmp_path: Path) -> None:
    path, link = tmp_path / "a.py", tmp_path / "b.py"
    path.write_bytes(b"x\n")
    path.chmod(0o751)
    link.symlink_to(path)
    write_fixed(link, b"x\n", b"y\n")
    assert link.is_symlink()
    assert path.read_bytes() == b"y\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o751


def test_a_file_that_was_changed_meanwhile_is_left(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_bytes(b"mine\n")
    with pytest.raises(OSError, match="changed meanwhile"):
        write_fixed(path, b"x\n", b"y\n")
    assert path.read_bytes() == b"mine\n"
