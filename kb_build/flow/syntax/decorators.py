"""Decorators of a script's own after which a function does what it did before."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import run_with

if TYPE_CHECKING:
    from collections.abc import Iterator

Definition = ast.FunctionDef | ast.AsyncFunctionDef


def hands_on(node: ast.AST) -> bool:
    """Whether a decorator gives back the function that it is given, or one that passes everything on to it."""
    if not isinstance(node, ast.FunctionDef) or not node.args.args:
        return False
    given = node.args.args[0].arg
    inner = _defined_in(node)
    results = [*_results(node)]
    return bool(results) and all(
        isinstance(result, ast.Name)
        and (result.id == given or (result.id in inner and _passes_on(inner[result.id], given)))
        for result in results
    )


def makes_one_that_hands_on(node: ast.AST) -> bool:
    """The same of a function that makes such a decorator: ``@registered("cube")``."""
    if not isinstance(node, ast.FunctionDef):
        return False
    inner = _defined_in(node)
    results = [*_results(node)]
    return bool(results) and all(
        isinstance(result, ast.Name) and result.id in inner and hands_on(inner[result.id])
        for result in results
    )


def _passes_on(node: Definition, given: str) -> bool:
    """Whether a function calls another with all that it is given, and returns what that returns."""
    arguments = node.args
    if arguments.args or arguments.posonlyargs or arguments.kwonlyargs:
        return False
    rows, named = arguments.vararg, arguments.kwarg
    if rows is None or named is None or any(map(_goes_on_after_error, run_with(node.body))):
        return False
    calls: set[str] = set()
    for part in run_with(node.body):
        match part:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if _is_call(value, given, rows, named):
                calls.add(name)
            case _:
                pass
    results = [*_results(node)]
    return bool(results) and all(
        _is_call(result, given, rows, named) or (isinstance(result, ast.Name) and result.id in calls)
        for result in results
    )


def _is_call(node: ast.AST | None, given: str, rows: ast.arg, named: ast.arg) -> bool:
    match node:
        case ast.Call(
            func=ast.Name(id=called),
            args=[ast.Starred(value=ast.Name(id=positional))],
            keywords=[ast.keyword(arg=None, value=ast.Name(id=by_name))],
        ):
            return (called, positional, by_name) == (given, rows.arg, named.arg)
        case _:
            return False


def _goes_on_after_error(node: ast.AST) -> bool:
    return isinstance(node, ast.ExceptHandler) and not isinstance(node.body[-1], ast.Raise)


def _defined_in(node: ast.FunctionDef) -> dict[str, Definition]:
    return {
        part.name: part for part in node.body if isinstance(part, (ast.FunctionDef, ast.AsyncFunctionDef))
    }


def _results(node: Definition) -> Iterator[ast.expr | None]:
    """What a function returns, what is defined in it aside."""
    for part in run_with(node.body):
        if isinstance(part, ast.Return):
            yield part.value
