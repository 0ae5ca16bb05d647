"""What a script surely makes itself, and what it may do to that."""

from __future__ import annotations

import ast
import math
import re
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import made_by
from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import ID, OBJECT
from kb_build.symbols.flags import fillers
from kb_check.calls.resolved import called_operators, callee_path, calls_only
from kb_check.scene.active_object import reads_active
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bindings import bindings, once_bound
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_DEEPEST = 8
# Operators after which everything that was there has as much as before, and as little.
_PLAIN = re.compile(
    r"bpy\.ops\.("
    r"(mesh|curve|surface)\.primitive_\w+_add"
    r"|object\.(armature|camera|effector|empty|grease_pencil|light|lightprobe|metaball|speaker|text|volume)_add"
    r"|object\.(delete|select_all|shade_flat|shade_smooth|origin_set|transform_apply|parent_clear)"
    r"|transform\.(translate|rotate|resize)"
    r"|wm\.(read_\w+|save_as_mainfile|save_mainfile)"
    r")"
)
_MAKING = "_add"  # how plain operators that make objects end
_PRIMITIVE = re.compile(r"bpy\.ops\.mesh\.primitive_\w+_add")
MESH = "bpy.types.Mesh"
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


def is_primitive(script: Script, node: ast.expr) -> bool:
    """Whether a thing surely is an object that an operator of meshes has just made."""
    node = once_bound(script, node)
    return isinstance(node, ast.Attribute) and _is_active_primitive(script, node)


def is_primitive_mesh(script: Script, node: ast.expr) -> bool:
    """Whether a thing surely is the mesh of an object that an operator has just made."""
    node = once_bound(script, node)
    return isinstance(node, ast.Attribute) and node.attr == "data" and is_primitive(script, node.value)


def _is_active_primitive(script: Script, node: ast.Attribute) -> bool:
    """Whether an expression reads the active object where that surely is a mesh that an operator has made.

    Behind the first operator that makes an object, plain operators leave none active but those that they make.
    """
    if not reads_active(script, node) or "active" in named_words(script):
        return False
    is_made = _first_made(script) <= (node.lineno, node.col_offset)
    is_sure = is_made and not _computes_members(script) and has_plain_operators_only(script)
    return is_sure and (_makes_meshes_only(script) or _is_mesh_object(script.type_of(node)))


def _is_mesh_object(kind: Type | None) -> bool:
    data = kind.trait("data") if isinstance(kind, Instance) and kind.sure else None
    return isinstance(data, Instance) and data.sure and data.cls == MESH


@once_per_script
def _makes_meshes_only(script: Script) -> bool:
    """Whether all plain operators that make objects make meshes: an effector has a field from the start."""
    making = (path for path in called_operators(script) if path.endswith(_MAKING))
    return all(map(_PRIMITIVE.fullmatch, making))


@once_per_script
def _first_made(script: Script) -> tuple[float, float]:
    """Where the first call of an operator ends that makes an object; behind everything for none."""
    made = [
        (row.node.end_lineno or 0, row.node.end_col_offset or 0)
        for row in script.resolutions("call")
        if isinstance(row.node, ast.Call) and any(map(made_by, row.symbols))
    ]
    return min(made, default=(math.inf, math.inf))


@once_per_script
def _computes_members(script: Script) -> bool:
    return any(node.id == "getattr" for node in script.all(ast.Name))


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
