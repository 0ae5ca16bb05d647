"""The tree of a modifier that ``bpy.ops.object.modifier_add`` has just added, where the script gives it none."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_check.calls.resolved import callee_path, calls_only
from kb_check.calls.sites import calls_by_node
from kb_check.modes.keeping import is_harmless
from kb_check.running.read_pointers import read_pointer
from kb_check.scene.active_object import reads_active
from kb_check.script import once_per_script
from kb_check.syntax.bindings import once_bound
from kb_check.syntax.bodies import innermost
from kb_check.syntax.words import asked_names, keywords_and_texts, stored_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ADD, _KIND = "bpy.ops.object.modifier_add", "NODES"
_POINTER = "node_group"
_SINCE = 3, 2  # before, the operator made a tree, too
# Operators that give trees to no modifier.
_BESIDE = re.compile(
    r"bpy\.ops\.(?!geometry\.|node\.|object\.(?:geometry|modifier_(?!add$))|ed\.|wm\.(?!read_|save_))\w+\.\w+"
)


def read_from_no_tree(script: Script) -> Iterator[ast.Attribute]:
    """What is read from the tree of such a modifier."""
    if script.version < _SINCE or not _stays_empty(script):
        return
    for node in script.all(ast.Attribute):
        pointer = read_pointer(script, node.value)
        if (
            pointer is not None
            and pointer.attr == _POINTER
            and _is_added(script, once_bound(script, pointer.value))
        ):
            yield node


@once_per_script
def _stays_empty(script: Script) -> bool:
    """Whether nothing in the script fills such a pointer, or asks whether it is None."""
    named = asked_names(script) | stored_names(script) | keywords_and_texts(script)
    adds = any(isinstance(node.func, ast.Attribute) and _adds(script, node) for node in script.all(ast.Call))
    return adds and _POINTER not in named and calls_only(script, _BESIDE)


def _is_added(script: Script, modifier: ast.expr) -> bool:
    """Whether an expression is the last modifier of the active object, to which an operator has just added one."""
    match modifier:
        case ast.Subscript(
            value=ast.Attribute(value=obj, attr="modifiers"),
            slice=ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=1)),
        ):
            pass
        case ast.Attribute(value=ast.Attribute(value=obj, attr="modifiers"), attr="active"):
            pass
        case _:
            return False
    if not reads_active(script, once_bound(script, obj)):
        return False
    body, place = innermost(script, modifier)
    for statement in reversed(body[:place]):
        value = statement.value if isinstance(statement, ast.Expr) else None
        if isinstance(value, ast.Call) and _adds(script, value):
            return True
        if not isinstance(statement, (ast.Assign, ast.Expr)) or _may_change(script, statement):
            return False
    return False


def _adds(script: Script, call: ast.Call) -> bool:
    if callee_path(script, call) != _ADD:
        return False
    site = calls_by_node(script).get(call)
    kind = site.argument("type") if site else None
    return isinstance(kind, ast.Constant) and kind.value == _KIND


def _may_change(script: Script, statement: ast.stmt) -> bool:
    """Whether a statement may make another object active, or another modifier the last one."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and node.attr == "active":
            return True
        if isinstance(node, ast.Call):
            path = callee_path(script, node)
            if (
                path.startswith(OPERATORS)
                or ".modifiers." in ast.unparse(node)
                or not (path or is_harmless(script, node))
            ):
                return True
    return False
