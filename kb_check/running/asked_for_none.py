"""What a script asks for None before it uses it: names, and what ``get`` finds."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


@once_per_script
def tested_names(script: Script) -> frozenset[str]:
    """The names that are part of some condition."""
    found = (node for condition in _conditions(script) for node in walk(condition))
    return frozenset(node.id for node in found if isinstance(node, ast.Name))


def is_ready_for_none(script: Script, key: ast.AST) -> bool:
    """Whether ``key`` is what a ``get`` looks for whose None does no harm: it has a default, is part of a condition or
    returned, or a name that is asked for holds it.
    """
    return id(key) in _ready_keys(script)


@once_per_script
def _ready_keys(script: Script) -> frozenset[int]:
    used = {id(node.value) for node in script.all(ast.Attribute, ast.Subscript)}
    calls = (each for each in _ready(script) if _is_get(each) and id(each) not in used)
    return frozenset(id(call.args[0]) for call in calls)


def _ready(script: Script) -> Iterator[ast.Call]:
    names = tested_names(script)
    told = [node.value for node in script.all(ast.Return)]
    for node in script.all(ast.Assign):
        if any(isinstance(target, ast.Name) and target.id in names for target in node.targets):
            told.append(node.value)
    for condition in _conditions(script):
        told += (node for node in walk(condition) if isinstance(node, ast.Call))
    for node in told:
        if isinstance(node, ast.Call):
            yield node
    for call in script.all(ast.Call):
        if len(call.args) > 1:  # what it gives where it finds nothing
            yield call
            yield from (each for each in call.args[1:] if isinstance(each, ast.Call))


def _is_get(call: ast.Call) -> bool:
    return bool(call.args) and isinstance(call.func, ast.Attribute) and call.func.attr == "get"


@once_per_script
def _conditions(script: Script) -> tuple[ast.AST, ...]:
    tests = [node.test for node in script.all(ast.If, ast.While, ast.IfExp, ast.Assert)]
    return (*tests, *script.all(ast.BoolOp, ast.Compare, ast.UnaryOp, ast.Match, ast.comprehension))
