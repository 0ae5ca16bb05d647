"""What Blender refuses as the value of a custom property, as tried.

======================================  =======================================
value                                   why
======================================  =======================================
a set, an iterator, a function, a       it keeps none of these
class, a module
a list of texts and numbers, or with    a list holds one kind: numbers, texts,
None in it                              dictionaries
======================================  =======================================
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Builtin,
    ClassObject,
    Collection,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalModule,
    Mapping,
    Module,
    Operator,
    Plain,
    Sequence,
    Tuple,
    members,
)
from kb_build.symbols.api_names import GROUPS, STRUCT
from kb_check.script import once_per_script
from kb_check.syntax.bindings import once_bound
from kb_check.values.lengths import is_iterator

if TYPE_CHECKING:
    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_NUMBERS = frozenset({"float", "int"})  # of which a list may hold both
_NONE = "None"
_OF_LIST = "a list of different kinds"


def refused_value(script: Script, target: ast.Subscript, value: ast.expr) -> str:
    """What is surely refused of what a statement gives to a custom property, in words; empty where it may be taken."""
    owner, key = script.type_of(target.value), script.type_of(target.slice)
    is_property = isinstance(key, Plain) and key.kind == "str" and _keeps_properties(script, owner)
    if not is_property or isinstance(target.slice, ast.Slice):
        return ""
    if is_iterator(script, value):
        return "an iterator"
    told = {_refused(kind) for kind in members(script.type_of(value) or UNKNOWN)}
    return told.pop() if len(told) == 1 else ""


def is_number_array(script: Script, node: ast.expr) -> bool:
    """Whether an expression surely reads a custom property that keeps an array: of the numbers of a list.

    That is known where the script gives nothing else to a property of this name.
    """
    match once_bound(script, node):
        case ast.Subscript(value=owner, slice=ast.Constant(value=str(key)), ctx=ast.Load()):
            given = _given(script).get(key, [])
            is_property = _keeps_properties(script, script.type_of(owner))
            return is_property and bool(given) and all(_is_row(script, value) for value in given)
        case _:
            return False


@once_per_script
def _given(script: Script) -> dict[str, list[ast.expr | None]]:
    """Key → what assignments give to it, in whatever; None where that is not one expression."""
    found: dict[str, list[ast.expr | None]] = {}
    for part in script.all(ast.Subscript):
        key = part.slice.value if isinstance(part.slice, ast.Constant) else None
        if isinstance(key, str) and not isinstance(part.ctx, ast.Load):
            found.setdefault(key, []).append(_assigned_to(script).get(part))
    return found


@once_per_script
def _assigned_to(script: Script) -> dict[ast.expr, ast.expr]:
    return {target: node.value for node in script.all(ast.Assign) for target in node.targets}


def _is_row(script: Script, value: ast.expr | None) -> bool:
    """Whether a value surely is a list of numbers."""
    match script.type_of(value) if value is not None else None:
        case Tuple(items=items):
            return bool(items) and all(map(_is_number, items))
        case Sequence(kind="list" | "tuple", element=element, is_empty=False):
            return _is_number(element)
        case _:
            return False


def _is_number(kind: Type) -> bool:
    return isinstance(kind, Plain) and kind.kind in _NUMBERS | {"bool"}


def _keeps_properties(script: Script, owner: Type | None) -> bool:
    """Whether brackets on a value surely mean custom properties."""
    match owner:
        case Instance(cls=cls, sure=True):
            return script.api.is_class(cls) and script.api.descends(cls, STRUCT) and cls != STRUCT
        case Collection(container=container):
            return container == GROUPS
        case _:
            return False


def _refused(kind: Type) -> str:
    """What a type is that no custom property keeps, in words; empty for what one may keep."""
    match kind:
        case Sequence(kind="set"):
            return "a set"
        case LocalFunction() | Function() | Operator() | Builtin():
            return "a function"
        case LocalClass() | ClassObject():
            return "a class"
        case Module() | LocalModule():
            return "a module"
        case Tuple(items=items):
            groups = set(map(_group, items)) - {""}
            return _OF_LIST if len(groups) > 1 or _NONE in groups else ""
        case _:
            return ""


def _group(kind: Type) -> str:
    """What all items of a list must be that has an item of a type; empty for what may be anything."""
    match kind:
        case Plain(kind=name):
            return "number" if name in _NUMBERS else name
        case Tuple() | Sequence():
            return "list"
        case Mapping():
            return "dict"
        case _:
            return _NONE if kind == NONE else ""
