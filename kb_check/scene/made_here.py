"""What a script surely makes itself, and what it may do to that."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID, OBJECT
from kb_build.symbols.flags import fillers
from kb_check.calls.resolved import called_operators, callee_path, calls_only
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bindings import bindings

if TYPE_CHECKING:
    from kb_check.script import Script

_DEEPEST = 8
# Operators that change nothing but the active object, which they leave as new as it is.
_PLAIN = re.compile(r"bpy\.ops\.(mesh\.primitive_\w+_add|object\.(select_all|shade_\w+|delete)|wm\.read_\w+)")
OBJECTS_NEW, LINKS_NEW = "bpy.types.BlendDataObjects.new", "bpy.types.NodeLinks.new"


def is_new(script: Script, node: ast.expr, depth: int = _DEEPEST) -> bool:
    """Whether the script has surely made what an expression is, or what it belongs to."""
    if not depth:
        return False
    match node:
        case ast.Name():
            return _is_new_name(script, (node.id, depth))
        case ast.Call():
            return callee_path(script, node).endswith(".new")
        case ast.Attribute():
            return _is_new_member(script, node, depth)
        case _:
            return False


@once_for_each
def _is_new_name(script: Script, name_and_depth: tuple[str, int]) -> bool:
    name, depth = name_and_depth
    values = bindings(script).get(name, [None])
    handed_on = name in _handed_on(script)
    return not handed_on and all(value and is_new(script, value, depth - 1) for value in values)


def _is_new_member(script: Script, node: ast.Attribute, depth: int) -> bool:
    row = script.analysis.resolutions.get(node)
    symbol = script.api.symbols.symbol(row.symbols[0]) if row and len(row.symbols) == 1 else None
    if symbol is None or symbol.type != "pointer":
        return False
    if calls := fillers(symbol):
        return any(call.partition("(")[0] in called_operators(script) for call in calls)
    if symbol.name == "data" and symbol.owner == OBJECT:
        return is_new(script, node.value, depth - 1) and has_new_data(script, node.value, depth - 1)
    points_elsewhere = script.names.reader.descends(f"bpy.types.{symbol.target}", ID)
    return not points_elsewhere and is_new(script, node.value, depth - 1)


def has_new_data(script: Script, node: ast.expr, depth: int = _DEEPEST) -> bool:
    """Whether an object was made with new data, which have nothing that they would give it."""
    if isinstance(node, ast.Name):
        return _has_new_data(script, (node.id, depth))
    return _is_made_with_new_data(script, node, depth)


@once_for_each
def _has_new_data(script: Script, name_and_depth: tuple[str, int]) -> bool:
    name, depth = name_and_depth
    values = bindings(script).get(name, [])
    return bool(values) and all(_is_made_with_new_data(script, value, depth) for value in values)


def _is_made_with_new_data(script: Script, node: ast.expr | None, depth: int) -> bool:
    return (
        isinstance(node, ast.Call)
        and callee_path(script, node) == OBJECTS_NEW
        and len(node.args) > 1
        and is_new(script, node.args[1], depth)
    )


def has_plain_operators_only(script: Script) -> bool:
    """Whether all operators that the script calls leave things that it made as they are."""
    return calls_only(script, _PLAIN)


@once_for_each
def makers(script: Script, name: str) -> frozenset[str]:
    """What is called for all that a name stands for; nothing where it stands for other values as well."""
    values = bindings(script).get(name, [])
    are_calls = all(isinstance(value, ast.Call) for value in values)
    paths = {callee_path(script, value) for value in values if isinstance(value, ast.Call)}
    return frozenset(paths) if are_calls else frozenset()


@once_per_script
def _handed_on(script: Script) -> frozenset[str]:
    """The names whose values are passed to functions that are neither the API's nor the script's own."""
    own = {node.name for node in script.all(ast.FunctionDef, ast.ClassDef)}
    found: set[str] = set()
    for node in script.all(ast.Call):
        if not callee_path(script, node):
            function = node.func
            name = function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")
            if name not in own:
                arguments = (*node.args, *(keyword.value for keyword in node.keywords))
                found.update(value.id for value in arguments if isinstance(value, ast.Name))
    return frozenset(found)
