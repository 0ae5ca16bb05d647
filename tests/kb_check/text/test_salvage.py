"""What is read of scripts that Python cannot parse."""

from __future__ import annotations

import ast

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kb_check.text.salvage import looks_like_python_2, parses, salvage


@pytest.mark.parametrize(
    ("broken", "kept"),
    [
        ("a\nb c\nd\n", ["a", "d"]),
        ("a\nf(1,\nd\n", ["a", "d"]),
        ("a\nif x:\nd\ne\n", ["a", "d", "e"]),
        ("a\n@deco\n\nd\ne\n", ["a", "d", "e"]),
        ("a\ntry:\n  b\nd\ne\n", ["a", "d", "e"]),
        ("a\ndef f():\n  b c\n  return 1\n\n  # more\nd\n", ["a", "d"]),
        ("a\nif x:\n  b\nelse:\n  c c\nd\n", ["a", "d"]),
        ('a\nprint "x"\nd\nprint "y"\ne\n', ["a", "d", "e"]),
        ("a\n\0\nd\n", ["a", "d"]),
        ("a\r\nb c\r\nd\r\n", ["a", "d"]),
        ("a\n  b\nc\n", ["c"]),
        ("b c", []),
    ],
)
def test_only_the_statements_that_fail_are_left_out(broken: str, kept: list[str]) -> None:
    part = salvage(broken)
    tree = ast.parse(part.code)
    lines = broken.splitlines()
    found = [lines[node.lineno - 1] for node in tree.body if "__unreadable__" not in ast.unparse(node)]
    assert found == kept


def test_what_a_lost_statement_binds_is_not_known_any_more() -> None:
    part = salvage("x = 1\nx, y = print 2\nimport z, print 1\nclass C: a b\nz\n")
    bound = {
        name.id
        for node in ast.walk(ast.parse(part.code))
        if isinstance(node, ast.Assign)
        for name in node.targets
    }
    assert {"x", "y", "z", "C"} <= bound


def test_what_a_lost_statement_may_register_is_known() -> None:
    part = salvage("a = 1\ndef register():\n    bpy.types.Scene.mine = 1\n    print 'x'\n    other = 2\n")
    assert "mine" in part.registered_names
    assert "other" not in part.registered_names


def test_a_script_with_too_many_faults_keeps_its_beginning() -> None:
    part = salvage("a = 1\n" + "b c\nd = 1\n" * 500)
    assert part.code.startswith("a = 1\n")
    assert len(ast.parse(part.code).body) > 40


@pytest.mark.parametrize(
    "code", ["(" * 5_000, "x = " + "-" * 100_000 + "1", "\n" * 300_000 + "def", " " * 300_000 + "def"]
)
def test_what_cannot_be_divided_ends(code: str) -> None:
    assert parses(salvage(code).code)


@pytest.mark.parametrize(
    ("code", "is_it"),
    [
        ("print 'a'", True), ("exec code", True), ("try:\n  x\nexcept A, e:\n  y", True), ("raise A, 'b'", True),
        ("print('a'", False), ("printer x y", False), ("x = 'print this' y", False), ("", False),
    ],
)  # fmt: skip
def test_python_2_is_recognised(code: str, is_it: bool) -> None:
    assert looks_like_python_2(code) is is_it


PIECES = [
    "x = 1",
    "if x:",
    "  y",
    "def f(",
    "):",
    "'''",
    '"',
    "@d",
    "else:",
    "\\",
    "\t",
    "print 1",
    "\0",
    "é = ",
    "}",
    "#",
    "\r",
    "\f",
]
random_code = st.lists(st.sampled_from(PIECES) | st.text(max_size=8), max_size=25).map("\n".join)


@example("'''\nx\n'''\ny z")
@given(random_code)
def test_whatever_is_left_can_be_parsed_and_lines_stay(code: str) -> None:
    part = salvage(code)
    assert parses(part.code)
    if part.code:
        assert part.code.count("\n") <= code.count("\n") + code.count("\r") + 1
