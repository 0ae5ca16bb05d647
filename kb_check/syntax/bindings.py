"""What the names of a script are bound to."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.script import once_per_script

if TYPE_CHECKING:
    from kb_check.script import Script


@once_per_script
def bindings(script: Script) -> dict[str, list[ast.expr | None]]:
    """Name → everything that it is bound to, None for what is no expression."""
    found: dict[str, list[ast.expr | None]] = {}
    assigned: set[ast.Name] = set()
    for node in script.all(ast.Assign, ast.AnnAssign, ast.arg):
        match node:
            case ast.Assign(targets=[ast.Name() as name]) | ast.AnnAssign(target=ast.Name() as name):
                found.setdefault(name.id, []).append(node.value)
                assigned.add(name)
            case ast.arg(arg=name):
                found.setdefault(name, []).append(None)
            case _:
                pass
    for node in script.all(ast.Name):
        if isinstance(node.ctx, ast.Store) and node not in assigned:
            found.setdefault(node.id, []).append(None)
    return found


@once_per_script
def iterated(script: Script) -> dict[str, list[ast.expr]]:
    """Name → what the loops go through that bind it."""
    found: dict[str, list[ast.expr]] = {}
    for node in script.all(ast.For, ast.AsyncFor, ast.comprehension):
        if isinstance(node.target, ast.Name):
            found.setdefault(node.target.id, []).append(node.iter)
    return found


def once_bound(script: Script, node: ast.expr) -> ast.expr:
    """The one value that a name has, or else the expression itself."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else []
    return values[0] if len(values) == 1 and values[0] else node


@once_per_script
def assignments(script: Script) -> dict[ast.expr, ast.Assign]:
    """Value → the statement that assigns it."""
    return {node.value: node for node in script.all(ast.Assign)}


def alias(script: Script, node: ast.expr) -> ast.expr:
    """What a name is another name of: the member that it is bound to, and to nothing else; else the node itself."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else []
    return values[0] if len(values) == 1 and isinstance(values[0], ast.Attribute) else node
