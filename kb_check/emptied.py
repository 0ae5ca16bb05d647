"""Where a script has surely made the file an empty one before: ``bpy.ops.wm.read_factory_settings(use_empty=True)``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.trees import children, walk
from kb_check.literals import functions
from kb_check.made_here import callee_path, owners, places
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from kb_check.script import Script

EMPTYING = frozenset({"bpy.ops.wm.read_factory_settings", "bpy.ops.wm.read_homefile"})
_Function = ast.FunctionDef | ast.AsyncFunctionDef


def is_emptied_before(script: Script, statement: ast.stmt) -> bool:
    """Whether the file surely is emptied before a statement is come to."""
    return _is_after(script, statement, frozenset())


@once_per_script
def empties_only(script: Script) -> bool:
    """Whether every file that a script reads is an empty one, and there is one."""
    calls = [node for node in script.all(ast.Call) if callee_path(script, node) in EMPTYING]
    return bool(calls) and all(map(_is_empty, calls))


def _is_empty(call: ast.Call) -> bool:
    return any(
        keyword.arg == "use_empty" and isinstance(keyword.value, ast.Constant) and keyword.value.value is True
        for keyword in call.keywords
    )


@once_per_script
def _emptying(script: Script) -> frozenset[ast.stmt]:
    """The statements that empty the file, or call a function of the script's that surely does."""
    calls: dict[ast.stmt, ast.Call] = {
        node: node.value for node in script.all(ast.Expr) if isinstance(node.value, ast.Call)
    }
    found = {node for node, call in calls.items() if callee_path(script, call) in EMPTYING}
    while True:
        emptying = {name for name, node in functions(script).items() if _empties(node.body, found)}
        more = {
            node
            for node, call in calls.items()
            if isinstance(call.func, ast.Name) and call.func.id in emptying
        }
        if more <= found:
            return frozenset(found)
        found |= more


def _empties(body: list[ast.stmt], emptying: set[ast.stmt]) -> bool:
    """Whether a function's body surely comes to one of the statements."""
    for statement in body:
        if statement in emptying:
            return True
        if any(
            isinstance(node, (ast.Return, ast.Raise, ast.Yield, ast.YieldFrom)) for node in walk(statement)
        ):
            return False
    return False


def _is_after(script: Script, statement: ast.stmt, followed: frozenset[str]) -> bool:
    emptying = _emptying(script)
    here: ast.AST | None = statement
    while isinstance(here, ast.stmt) and here in places(script):
        body, place = places(script)[here]
        if not emptying.isdisjoint(body[:place]):
            return True
        here = owners(script)[here]
        if isinstance(here, _Function):
            return _is_called_after(script, here, followed)
    return False


def _is_called_after(script: Script, function: _Function, followed: frozenset[str]) -> bool:
    """Whether the script calls one of its functions, and only behind what empties the file."""
    name = function.name
    if name in followed or functions(script).get(name) is not function or function.decorator_list:
        return False
    named = [node for node in script.all(ast.Name) if node.id == name and isinstance(node.ctx, ast.Load)]
    calls = {node.func: node for node in script.all(ast.Call)}
    around = _around(script)
    return bool(named) and all(
        node in calls
        and (statement := around.get(calls[node])) is not None
        and _is_after(script, statement, followed | {name})
        for node in named
    )


@once_per_script
def _around(script: Script) -> dict[ast.Call, ast.stmt]:
    """The innermost statement around each call."""
    found: dict[ast.Call, ast.stmt] = {}
    for statement in places(script):
        waiting: list[ast.AST] = [*children(statement)]
        while waiting:
            node = waiting.pop()
            if isinstance(node, (ast.stmt, ast.ExceptHandler, ast.match_case)):
                continue
            if isinstance(node, ast.Call):
                found[node] = statement
            waiting += children(node)
    return found
