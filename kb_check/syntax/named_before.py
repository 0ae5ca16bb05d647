"""Where a script names a word first, and whether that is before a place."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.script import once_per_script
from kb_check.syntax.bodies import places, statement_of
from kb_check.syntax.words import words_of

if TYPE_CHECKING:
    from collections.abc import Collection

    from kb_check.script import Script


def is_named_before(script: Script, word: str, place: ast.expr) -> bool:
    """Whether a word may have had an effect when the script comes to a place: any of it, within a function."""
    first = first_named(script).get(word)
    return first is not None and first <= stage(script, place)


def is_named_only_behind(script: Script, word: str, statement: ast.stmt) -> bool:
    """Whether nothing but later statements of the same body name a setting, which has no effect then the first time."""
    if statement not in places(script):
        return False
    body, _ = places(script)[statement]
    start = statement.end_lineno or 0, statement.end_col_offset or 0
    end = body[-1].end_lineno or 0, body[-1].end_col_offset or 0
    naming = [
        node for node in script.all(ast.Attribute, ast.keyword, ast.Constant) if word in words_of([node])
    ]
    return all(start <= (node.lineno, node.col_offset) < end for node in naming)


def stage(script: Script, place: ast.expr) -> int:
    """The number of the statement of the module that a place is in; within a function, the last one."""
    body = script.tree.body
    number = statement_of(body, place)
    is_apart = number < 0 or isinstance(body[number], (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
    return len(body) if is_apart else number


@once_per_script
def first_named(script: Script) -> dict[str, int]:
    """Each word of the script that may name a setting → the number of the statement of the module that has it first."""
    return first_named_but(script, frozenset())


def first_named_but(script: Script, nodes: Collection[ast.AST]) -> dict[str, int]:
    """The same without what some nodes name themselves."""
    found: dict[str, int] = {}
    for number, statement in enumerate(script.tree.body):
        for word in words_of(node for node in walk(statement) if node not in nodes):
            found.setdefault(word, number)
    return found
