"""The bodies of statements: which a statement has, which a script has, and where a statement stands in them."""

from __future__ import annotations

import ast
from bisect import bisect_right
from typing import TYPE_CHECKING

from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_check.script import Script

_BODIES: tuple[type[ast.AST], ...] = (
    ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.If, ast.For, ast.AsyncFor, ast.While, ast.With,
    ast.AsyncWith, ast.Try, ast.TryStar, ast.ExceptHandler, ast.match_case,
)  # fmt: skip


def bodies_of(node: ast.AST) -> Iterator[list[ast.stmt]]:
    """Every list of statements in one: its body, ``else``, handlers, ``finally`` and cases."""
    for name in ("body", "orelse", "finalbody"):
        if isinstance(body := getattr(node, name, None), list):
            yield body
    match node:
        case ast.Try(handlers=parts) | ast.TryStar(handlers=parts) | ast.Match(cases=parts):
            yield from (part.body for part in parts)
        case _:
            pass


def statement_of(body: Sequence[ast.stmt], node: ast.expr) -> int:
    """The place of the statement of a body that a node is in; -1 for none."""
    at = node.lineno, node.col_offset
    place = bisect_right(body, at, key=start_of) - 1
    if place < 0:
        return -1
    end = body[place].end_lineno or 0, body[place].end_col_offset or 0
    return place if at < end else -1


def innermost(script: Script, node: ast.expr) -> tuple[list[ast.stmt], int]:
    """The innermost body with a statement that a node is in, and that statement's place; ([], 0) for none."""
    found = [(body, at) for body in bodies(script) if (at := statement_of(body, node)) >= 0]
    return max(found, key=lambda row: start_of(row[0][row[1]]), default=([], 0))


def start_of(statement: ast.stmt) -> tuple[int, int]:
    """The line and column at which a statement begins."""
    return statement.lineno, statement.col_offset


@once_per_script
def places(script: Script) -> dict[ast.stmt, tuple[list[ast.stmt], int]]:
    """Statement → the body that it is in, and its place there."""
    return {statement: (body, place) for _, body in _blocks(script) for place, statement in enumerate(body)}


@once_per_script
def bodies(script: Script) -> list[list[ast.stmt]]:
    """The bodies of statements that a script has."""
    return [body for _, body in _blocks(script) if body]


@once_per_script
def owners(script: Script) -> dict[ast.stmt, ast.AST]:
    """Statement → what has the body that it is in."""
    return {statement: owner for owner, body in _blocks(script) for statement in body}


def _blocks(script: Script) -> Iterator[tuple[ast.AST, list[ast.stmt]]]:
    for node in script.all(*_BODIES):
        for field in ("body", "orelse", "finalbody"):
            body = getattr(node, field, None)
            if isinstance(body, list):
                yield node, body
