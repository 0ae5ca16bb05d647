"""Where a script has surely made the file an empty one before: ``bpy.ops.wm.read_factory_settings(use_empty=True)``;
or has at least left it no objects.
"""

from __future__ import annotations

import ast
from collections import Counter
from typing import TYPE_CHECKING, Literal

from kb_build.flow.syntax.trees import children, walk
from kb_check.calls.resolved import callee_path
from kb_check.scene.deleted import deleting_all, deleting_selected
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bodies import owners, places
from kb_check.syntax.definitions import FunctionDefinition
from kb_check.syntax.literals import functions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_FACTORY = "bpy.ops.wm.read_factory_settings"
EMPTYING = frozenset({_FACTORY, "bpy.ops.wm.read_homefile"})
What = Literal["file", "objects"]  # that is emptied: an empty file has no objects


def is_emptied_before(script: Script, statement: ast.stmt, what: What = "file") -> bool:
    """Whether the file, or its objects, surely are emptied before a statement is come to."""
    is_after, function = _standing(script, statement, what)
    return is_after or (function is not None and function in _called_after(script, what))


@once_for_each
def empties_only(script: Script, what: What) -> bool:
    """Whether every file that a script reads is an empty one, and something is emptied."""
    calls = [node for node in script.all(ast.Call) if callee_path(script, node) in EMPTYING]
    deletes = what == "objects" and bool(deleting_all(script) | deleting_selected(script))
    return (bool(calls) or deletes) and all(map(_is_empty, calls))


@once_per_script
def resets_only(script: Script) -> bool:
    """Whether every file that a script reads is an empty one or that of the factory, and it reads one."""
    calls = [node for node in script.all(ast.Call) if callee_path(script, node) in EMPTYING]
    return bool(calls) and all(_is_empty(call) or callee_path(script, call) == _FACTORY for call in calls)


def _is_empty(call: ast.Call) -> bool:
    return any(
        keyword.arg == "use_empty" and isinstance(keyword.value, ast.Constant) and keyword.value.value is True
        for keyword in call.keywords
    )


@once_for_each
def _emptying(script: Script, what: What) -> frozenset[ast.stmt]:
    """The statements that empty it, or call a function of the script's that surely does."""
    found: list[ast.stmt] = []
    if what == "objects":
        found += deleting_all(script) | deleting_selected(script)
    callers: dict[str, list[ast.stmt]] = {}
    for node in script.all(ast.Expr):
        match node.value:
            case ast.Call() as call if callee_path(script, call) in EMPTYING:
                found.append(node)
            case ast.Call(func=ast.Name(id=name)):
                callers.setdefault(name, []).append(node)
            case _:
                pass
    names = {
        statement: name
        for name, node in functions(script).items()
        for statement in _surely_come_to(node.body)
    }
    for statement in found:  # which grows
        found += callers.pop(names.get(statement, ""), ())
    return frozenset(found)


def _surely_come_to(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements of a function's body that a call surely comes to."""
    for statement in body:
        yield statement
        if any(
            isinstance(node, (ast.Return, ast.Raise, ast.Yield, ast.YieldFrom)) for node in walk(statement)
        ):
            return


def _standing(script: Script, statement: ast.stmt, what: What) -> tuple[bool, FunctionDefinition | None]:
    """Whether a statement stands behind what empties it, and if not, the function that it is in."""
    here: ast.AST | None = statement
    while isinstance(here, ast.stmt) and here in places(script):
        body, place = places(script)[here]
        if _first_emptying(script, what).get(body[0], place) < place:
            return True, None
        here = owners(script)[here]
        if isinstance(here, FunctionDefinition):
            return False, here
    return False, None


@once_for_each
def _first_emptying(script: Script, what: What) -> dict[ast.stmt, int]:
    """First statement of a body → the place there of the first one that empties it."""
    found: dict[ast.stmt, int] = {}
    for statement in _emptying(script, what):
        if statement in places(script):
            body, place = places(script)[statement]
            found[body[0]] = min(place, found.get(body[0], place))
    return found


@once_for_each
def _called_after(script: Script, what: What) -> frozenset[ast.AST]:
    """The functions that the script calls, and only behind what empties it."""
    named: dict[str, list[ast.Name]] = {}
    for node in script.all(ast.Name):
        if isinstance(node.ctx, ast.Load):
            named.setdefault(node.id, []).append(node)
    found: list[ast.AST] = []
    missing: Counter[ast.AST] = Counter()  # functions that have to be called so first
    users: dict[ast.AST, list[ast.AST]] = {}
    for name, function in functions(script).items():
        outer = None if function.decorator_list else _callers(script, named.get(name, []), what)
        if outer is None:
            continue
        missing[function] = len(outer)
        for caller in outer:
            users.setdefault(caller, []).append(function)
        if not outer:
            found.append(function)
    for function in found:  # which grows
        for user in users.get(function, ()):
            missing[user] -= 1
            if not missing[user]:
                found.append(user)
    return frozenset(found)


def _callers(script: Script, named: list[ast.Name], what: What) -> list[FunctionDefinition] | None:
    """The functions in which another one is called where it may not be empty yet.

    None where it is never called, used for more than that, or called so in no function.
    """
    found: list[FunctionDefinition] = []
    for node in named:
        call = script.calls_of.get(node)
        statement = _around(script).get(call) if call else None
        is_after, function = _standing(script, statement, what) if statement else (False, None)
        if not is_after:
            if function is None:
                return None
            found.append(function)
    return found if named else None


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
