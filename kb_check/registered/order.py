"""Where a script registers its classes, and in which order."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_check.calls.resolved import callee_path
from kb_check.script import once_per_script
from kb_check.syntax.literals import lists_left_alone, written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

# A body of the script, a statement in it, and an item of the list that it goes through.
Place = tuple[int, int, int]

_REGISTER, _FACTORY = "bpy.utils.register_class", "bpy.utils.register_classes_factory"


@dataclass(frozen=True, slots=True)
class Registration:
    """A class that is registered: ``node`` names it."""

    node: ast.Name
    place: Place

    def is_behind(self, other: Place) -> bool:
        """Whether this surely comes later."""
        return self.place[0] == other[0] and self.place > other


@once_per_script
def registrations(script: Script) -> dict[str, list[Registration]]:
    """Name → where the class is registered: by itself, or out of a list that is written out."""
    found: dict[str, list[Registration]] = {}
    for body, number, statement in statements(script):
        for item, (group, node) in enumerate(_registered(script, statement)):
            found.setdefault(node.id, []).append(Registration(node, (group or body, number, item)))
    return found


@once_per_script
def statements(script: Script) -> list[tuple[int, int, ast.stmt]]:
    """(body, number, statement) of the statements of the module and of its functions."""
    bodies = [script.tree.body, *(node.body for node in script.all(ast.FunctionDef))]
    return [
        (place, number, statement)
        for place, body in enumerate(bodies)
        for number, statement in enumerate(body)
    ]


def _registered(script: Script, statement: ast.stmt) -> Iterator[tuple[int, ast.Name]]:
    """The classes that a statement registers, each with a number of its own group, or 0 for the statement's body."""
    match statement:
        case ast.Expr(value=ast.Call(args=[ast.Name() as node]) as call) if _calls(script, call, _REGISTER):
            yield 0, node
        case ast.For(target=ast.Name(id=name), iter=several) if any(
            isinstance(inner, ast.Expr)
            and isinstance(inner.value, ast.Call)
            and _calls(script, inner.value, _REGISTER)
            and [ast.unparse(part) for part in inner.value.args] == [name]
            for inner in statement.body
        ):
            for node in _listed(script, several):
                yield 0, node
        case ast.Assign(value=ast.Call(args=[several]) as call) if _calls(script, call, _FACTORY):
            for node in _listed(script, several):
                yield id(call), node
        case _:
            pass


def _calls(script: Script, call: ast.Call, path: str) -> bool:
    return callee_path(script, call) == path


def _listed(script: Script, node: ast.expr) -> list[ast.Name]:
    """The names in a list that is written out."""
    if isinstance(node, ast.Name):
        node = lists_left_alone(script).get(node.id) or written(script, node)
    parts = node.elts if isinstance(node, (ast.Tuple, ast.List)) else []
    names = [part for part in parts if isinstance(part, ast.Name)]
    return names if len(names) == len(parts) else []
