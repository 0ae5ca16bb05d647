"""What is written out in a script: literals, and the names that hold one and nothing else."""

from __future__ import annotations

import ast
from collections import Counter
from typing import TYPE_CHECKING

from kb_check.findings import Edit, Fix
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from kb_check.script import Script

_DEEPEST = 4
# The nodes that bind names; of type parameters those that this Python has.
_TYPE_PARAMETERS = ("ParamSpec", "TypeVar", "TypeVarTuple")
_BINDING: tuple[type[ast.AST], ...] = (
    ast.Name, ast.arg, ast.alias, ast.Global, ast.Nonlocal, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef,
    ast.ExceptHandler, ast.MatchAs, ast.MatchStar, ast.MatchMapping,
    *(getattr(ast, name) for name in _TYPE_PARAMETERS if hasattr(ast, name)),
)  # fmt: skip
_LITERALS = (ast.Constant, ast.UnaryOp, ast.Tuple, ast.Name)


def written(script: Script, node: ast.expr) -> ast.expr:
    """The expression that stands for a value: a name that is bound once in the whole script leads to what it holds."""
    for _ in range(_DEEPEST):
        if not isinstance(node, ast.Name):
            break
        found = _once_bound(script).get(node.id)
        if found is None:
            break
        node = found
    return node


def number(script: Script, node: ast.expr) -> float | int | None:
    """The number that an expression is written as; None for what is computed, and for truth values."""
    node = written(script, node)
    sign = 1
    while isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        sign = -sign if isinstance(node.op, ast.USub) else sign
        node = node.operand
    if (
        isinstance(node, ast.Constant)
        and isinstance(node.value, (int, float))
        and not isinstance(node.value, bool)
    ):
        return sign * node.value
    return None


def items(script: Script, node: ast.expr) -> list[ast.expr] | None:
    """The items of a tuple or a list that is written out; None for anything else."""
    written_out = written(script, node)
    display = isinstance(written_out, ast.Tuple) or (written_out is node and isinstance(node, ast.List))
    if not display or not isinstance(written_out, (ast.Tuple, ast.List)):
        return None
    return None if any(isinstance(item, ast.Starred) for item in written_out.elts) else written_out.elts


def set_of(script: Script, node: ast.Constant) -> Fix:
    """Writes a set in the place of the one value that is to be in it."""
    span = script.span(node)
    return Fix("Write a set", (Edit(span, f"{{{script.text(span)}}}"),), sure=True)


@once_per_script
def functions(script: Script) -> dict[str, ast.FunctionDef]:
    """Name → the function of the script that is called so, where nothing else is."""
    found = {node.name: node for node in script.all(ast.FunctionDef)}
    times = times_bound(script)
    return {name: node for name, node in found.items() if times[name] == 1}


@once_per_script
def times_bound(script: Script) -> Counter[str]:
    """How often each name is bound, wherever."""
    return Counter(name for node in script.all(*_BINDING) for name in bound_names(node))


@once_per_script
def _once_bound(script: Script) -> dict[str, ast.expr]:
    """Name → the literal that its only assignment gives it. A list is none: it may grow."""
    times = times_bound(script)
    values: dict[str, ast.expr] = {}
    for node in script.all(ast.Assign):
        if isinstance(node.value, _LITERALS):
            values |= {target.id: node.value for target in node.targets if isinstance(target, ast.Name)}
    return {name: value for name, value in values.items() if times[name] == 1}


@once_per_script
def lists_left_alone(script: Script) -> dict[str, ast.expr]:
    """Name → the list that its only assignment gives it, where nothing is done to it by its name."""
    changed = {
        node.value.id for node in script.all(ast.Attribute, ast.Subscript) if isinstance(node.value, ast.Name)
    }
    changed |= {node.target.id for node in script.all(ast.AugAssign) if isinstance(node.target, ast.Name)}
    times = times_bound(script)
    return {
        target.id: node.value
        for node in script.all(ast.Assign)
        if isinstance(node.value, ast.List)
        for target in node.targets
        if isinstance(target, ast.Name) and times[target.id] == 1 and target.id not in changed
    }


def bound_names(node: ast.AST) -> list[str]:
    """The names that a node binds, or makes another scope's."""
    match node:
        case ast.Name(ctx=ast.Store() | ast.Del()):
            return [node.id]
        case ast.arg():
            return [node.arg]
        case ast.alias():
            return [(node.asname or node.name).partition(".")[0]]
        case ast.Global() | ast.Nonlocal():
            return node.names
        case _:
            name = getattr(node, "rest" if isinstance(node, ast.MatchMapping) else "name", None)
            return [name] if isinstance(name, str) else []
