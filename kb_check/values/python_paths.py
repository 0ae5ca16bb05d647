"""Where a script surely has one of Python's path objects, which Blender takes for no text."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.literals import times_bound

if TYPE_CHECKING:
    from kb_check.script import Script

_MODULE = "pathlib"
_CLASSES = frozenset({"Path", "PurePath", "PosixPath", "PurePosixPath", "WindowsPath", "PureWindowsPath"})
_MADE_BY = frozenset({"cwd", "home"})
# What gives another path.
_KEEPING = frozenset(
    {"absolute", "expanduser", "joinpath", "relative_to", "resolve", "with_name", "with_stem", "with_suffix"}
)
_DEEPEST = 20


def is_path(  # noqa: PLR0911 - one return a form
    script: Script, node: ast.expr, depth: int = _DEEPEST
) -> bool:
    """Whether an expression is a path of ``pathlib``."""
    if not depth:
        return False
    match node:
        case ast.Name(id=name):
            values = bindings(script).get(name, [])
            return bool(values) and all(value and is_path(script, value, depth - 1) for value in values)
        case ast.BinOp(op=ast.Div(), left=left):
            return is_path(script, left, depth - 1)
        case ast.Attribute(value=value, attr="parent"):
            return is_path(script, value, depth - 1)
        case ast.Call(func=ast.Attribute(value=value, attr=name)) if name in _KEEPING:
            return is_path(script, value, depth - 1)
        case ast.Call(func=ast.Attribute(value=value, attr=name)) if name in _MADE_BY:
            return _is_class(script, value)
        case ast.Call(func=function):
            return _is_class(script, function)
        case _:
            return False


def _is_class(script: Script, node: ast.expr) -> bool:
    match node:
        case ast.Name(id=name):
            return name in _imported(script)
        case ast.Attribute(value=ast.Name(id=module), attr=name):
            return name in _CLASSES and module in _imported(script)
        case _:
            return False


@once_per_script
def _imported(script: Script) -> frozenset[str]:
    """The names that the module, and its classes, are imported as, and nothing else is called."""
    found = [
        alias.asname or alias.name
        for node in script.all(ast.Import)
        for alias in node.names
        if alias.name == _MODULE
    ]
    found += [
        alias.asname or alias.name
        for node in script.all(ast.ImportFrom)
        for alias in node.names
        if node.module == _MODULE and not node.level and alias.name in _CLASSES
    ]
    return frozenset(name for name in found if times_bound(script)[name] == found.count(name))
