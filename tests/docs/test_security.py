"""SECURITY.md names, for each promise, tests that attack it; they are there."""

from __future__ import annotations

import ast
import re

import pytest
from places import REPO

_ROW = re.compile(r"^\| (?P<promise>[^|]+) \| (?P<tests>[^|]*\]\(tests/[^|]*) \|$", re.MULTILINE)
_LINK = re.compile(r"\[([\w-]+)\]\((tests/[\w/]+\.py)\)")
SECURITY = (REPO / "SECURITY.md").read_text(encoding="utf-8")
ROWS = {row["promise"]: _LINK.findall(row["tests"]) for row in _ROW.finditer(SECURITY)}
# The rows of "What it withstands", by how each begins, with a word of the promises that it is made of.
PARTS = {
    "code in the live Blender": "code ",
    "the worker that runs": "worker",
    "programs of other users": "strangers",
    "`.blend` files": "`.blend`",
    "documentation sources": "documentation sources",
    "HTTP clients": "HTTP",
    "clients of `simworlds mcp": "blender-mcp",
    "ready knowledge bases": "ready base",
    "names and texts": "steers",
}


def functions(path: str) -> set[str]:
    tree = ast.parse((REPO / path).read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}


def test_every_kind_of_promise_is_in_the_table() -> None:
    withstands = SECURITY.partition("## What it withstands")[2].partition("\n## ")[0]
    rows = [row for row in withstands.splitlines() if row.startswith("| ")][1:]
    rows = [row.removeprefix("| ") for row in rows if not row.startswith("| ---")]
    assert len(rows) == len(PARTS)
    for row in rows:
        (part,) = [word for beginning, word in PARTS.items() if row.startswith(beginning)]
        assert any(part in promise for promise in ROWS), row


@pytest.mark.parametrize("promise", ROWS)
def test_the_tests_that_attack_a_promise_are_there(promise: str) -> None:
    assert ROWS[promise]
    for name, path in ROWS[promise]:
        if path.startswith("tests/attacks/ways/"):
            assert path == f"tests/attacks/ways/{name}.py"
            assert "WAYS" in (REPO / path).read_text(encoding="utf-8")
        else:
            assert name in functions(path), f"{path} has no {name}"


def test_every_file_of_attacks_on_the_sandbox_is_named() -> None:
    named = {path for tests in ROWS.values() for _, path in tests}
    ways = {path.relative_to(REPO).as_posix() for path in (REPO / "tests/attacks/ways").glob("*.py")}
    assert ways - {"tests/attacks/ways/__init__.py"} <= named
