"""What a thing of a script is among those that were tried with a call, where it is one of those that refused it."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA
from kb_build.symbols.paths import last_name
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import calls_by_node
from kb_check.nodes.trees import tree_of
from kb_check.scene.made_here import OBJECTS_NEW
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Refusal
    from kb_check.script import Script

_LIGHT = f"{T}Light"
# Until Blender 4.2, which has modifiers of their own for them, of objects of type GPENCIL.
_GREASE_PENCIL, _FORMER_MODIFIERS = "GreasePencil", f"{T}GpencilModifier"


def refusing_kind(script: Script, owner: ast.expr, refusal: Refusal) -> str:
    """What something is that refuses a call by what it is; empty where that is not known."""
    thing = owner.value if isinstance(owner, ast.Attribute) else owner
    labels = [*_labels(script, thing)]
    if not set(labels).isdisjoint(refusal.taken_by):
        return ""
    return next((label for label in labels if label in refusal.by), "")


def _labels(script: Script, thing: ast.expr) -> Iterator[str]:
    """What a thing is called as one that was tried, the most telling first: ``bezier spline``, ``LIGHT object``."""
    kind = script.type_of(thing)
    symbol = script.api.symbols.symbol(kind.cls) if isinstance(kind, Instance) else None
    if symbol is None or not isinstance(kind, Instance):
        return
    if made_as := _made_as(script, thing):
        yield f"{made_as} {symbol.label.lower()}"
    tree = script.api.symbols.symbol(f"{T}{tree_of(script, thing)}")
    if tree is not None:
        yield f"{symbol.label.lower()} in a {tree.label.lower()}"
    if kind.sure:
        yield symbol.label.lower()
    data = dict(kind.traits).get("data") if kind.cls == OBJECT else None
    if kind.cls == OBJECT and _has_no_data(script, thing):
        yield "EMPTY object"
    elif isinstance(data, Instance) and data.sure:
        # A light is of a class for its type; curves of several classes are of several types.
        cls = _LIGHT if script.api.descends(data.cls, _LIGHT) else data.cls
        yield f"{_type_of_object(script, last_name(cls))} object"


def _type_of_object(script: Script, data: str) -> str:
    """The type of an object whose data is of a class."""
    if data == _GREASE_PENCIL and not script.api.is_class(_FORMER_MODIFIERS):
        return data.upper()
    return next((kind for kind, cls in OBJECT_DATA.items() if cls == data), data.upper())


def _has_no_data(script: Script, node: ast.expr) -> bool:
    """Whether the one object that a name stands for was made without data."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else []
    match values:
        case [ast.Call() as made] if callee_path(script, made) == OBJECTS_NEW:
            given = [*made.args[1:2], *(word.value for word in made.keywords if word.arg == "object_data")]
            return [ast.unparse(node) for node in given] == ["None"]
        case _:
            return False


def _made_as(script: Script, node: ast.expr) -> str:
    """The kind that something, or a name's one value, is made with, where nothing changes it; empty if not known."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else [node]
    made = values[0] if len(values) == 1 else None
    if (
        not isinstance(made, ast.Call)
        or not callee_path(script, made).endswith(".new")
        or _is_retyped(script)
    ):
        return ""
    site = calls_by_node(script).get(made)
    for parameter, given in site.arguments() if site else ():
        if parameter.enum_items and isinstance(given, ast.Constant) and isinstance(given.value, str):
            return given.value.lower()
    return ""


@once_per_script
def _is_retyped(script: Script) -> bool:
    """Whether a script gives something another type."""
    return any(node.attr == "type" and isinstance(node.ctx, ast.Store) for node in script.all(ast.Attribute))
