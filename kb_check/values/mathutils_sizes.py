"""How many components the vectors of a script have, and its matrices rows and columns, where that is sure."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.calls.resolved import callee_path, member_path
from kb_check.script import once_for_each
from kb_check.syntax.bindings import bindings
from kb_check.syntax.literals import number, written
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from kb_check.script import Script

VECTOR, MATRIX, QUATERNION = "mathutils.Vector", "mathutils.Matrix", "mathutils.Quaternion"
# (components,) of a vector, (rows, columns) of a matrix; () where that is not known.
Size = tuple[int, ...]

_DEEPEST = 20
_MOST = 4  # rows and columns
_RESIZING = frozenset({"resize", "resize_2d", "resize_3d", "resize_4d", "resize_4x4"})
_AXES = frozenset("xyzw")
# What gives the same size, whatever it is called with.
_OF_CALLS = {
    "mathutils.Matrix.to_2x2": (2, 2), "mathutils.Matrix.to_3x3": (3, 3), "mathutils.Matrix.to_4x4": (4, 4),
    "mathutils.Euler.to_matrix": (3, 3), "mathutils.Quaternion.to_matrix": (3, 3),
    "mathutils.Matrix.Translation": (4, 4), "mathutils.Matrix.LocRotScale": (4, 4),
    "mathutils.Matrix.to_translation": (3,), "mathutils.Matrix.to_scale": (3,),
    "mathutils.Vector.to_2d": (2,), "mathutils.Vector.to_3d": (3,), "mathutils.Vector.to_4d": (4,),
    "bpy_extras.object_utils.world_to_camera_view": (3,),
    "bpy_extras.view3d_utils.region_2d_to_location_3d": (3,), "bpy_extras.view3d_utils.region_2d_to_origin_3d": (3,),
    "bpy_extras.view3d_utils.region_2d_to_vector_3d": (3,),
}  # fmt: skip
# What is told the number of rows and columns, and which argument that is.
SIZED = {
    "mathutils.Matrix.Identity": 0, "mathutils.Matrix.Rotation": 1, "mathutils.Matrix.Scale": 1,
    "mathutils.Matrix.OrthoProjection": 1, "mathutils.Matrix.Shear": 1,
}  # fmt: skip
# Methods that give what has the size of what they are called on.
_KEEPING = frozenset(
    {
        *(f"{VECTOR}.{name}" for name in ("copy", "lerp", "normalized", "orthogonal", "project", "reflect", "slerp")),
        *(f"{MATRIX}.{name}" for name in ("adjugated", "copy", "inverted", "inverted_safe", "lerp", "normalized")),
    }
)  # fmt: skip
_TRANSPOSED = f"{MATRIX}.transposed"


def size_of(script: Script, node: ast.expr, depth: int = _DEEPEST) -> Size:
    """The size of what an expression gives; () where that is no vector and no matrix, or not sure."""
    cls = script.class_of(node)
    if cls not in {VECTOR, MATRIX} or not depth or not _RESIZING.isdisjoint(named_words(script)):
        return ()
    size: Size = ()
    match node:
        case ast.Name():
            size = _of_name(script, (node.id, depth - 1))
        case ast.Call():
            size = _of_call(script, node, depth - 1)
        case ast.Attribute():
            size = _of_member(script, node)
        case ast.BinOp():
            size = _of_operation(script, node, depth - 1)
        case ast.UnaryOp():
            size = size_of(script, node.operand, depth - 1)
        case _:
            pass
    return size


@once_for_each
def _of_name(script: Script, name_and_depth: tuple[str, int]) -> Size:
    """The size of all that a name is bound to."""
    name, depth = name_and_depth
    values = bindings(script).get(name, [None])
    sizes = {size_of(script, value, depth) if value is not None else () for value in values}
    return sizes.pop() if len(sizes) == 1 else ()


def _of_call(script: Script, call: ast.Call, depth: int) -> Size:
    path = callee_path(script, call)
    if path in _OF_CALLS:
        return _OF_CALLS[path]
    if isinstance(call.func, ast.Attribute) and path in {*_KEEPING, _TRANSPOSED}:
        size = size_of(script, call.func.value, depth)
        return size[::-1] if path == _TRANSPOSED else size
    if any(isinstance(one, ast.Starred) for one in call.args) or call.keywords:
        return ()
    return _of_new(script, path, call.args, depth)


def _of_new(script: Script, path: str, given: list[ast.expr], depth: int) -> Size:
    """The size of what a class, or a function that makes one of its instances, is called for."""
    match path, given:
        case ("mathutils.Vector", []):
            return (3,)
        case ("mathutils.Vector", [items]):
            return _of_items(script, items, depth)
        case ("mathutils.Matrix", []):
            return (4, 4)
        case ("mathutils.Matrix", [rows]):
            return _of_rows(script, rows)
        case ("mathutils.Matrix.Diagonal", [items]):
            return _of_items(script, items, depth) * 2
        case _:
            count = number(script, given[SIZED[path]]) if len(given) > SIZED.get(path, len(given)) else None
            return (count, count) if isinstance(count, int) else ()


def _of_items(script: Script, node: ast.expr, depth: int) -> Size:
    """The size of a vector that is made of an expression."""
    shown = written(script, node)
    if isinstance(shown, (ast.Tuple, ast.List)):
        is_open = any(isinstance(item, ast.Starred) for item in shown.elts)
        return () if is_open else (len(shown.elts),)
    return size_of(script, node, depth)


def _of_rows(script: Script, node: ast.expr) -> Size:
    shown = written(script, node)
    rows = shown.elts if isinstance(shown, (ast.Tuple, ast.List)) else []
    sizes = {_of_items(script, row, 1) for row in rows}
    return (len(rows), *sizes.pop()) if len(sizes) == 1 and () not in sizes else ()


def _of_member(script: Script, node: ast.Attribute) -> Size:
    if script.class_of(node.value) == VECTOR and _AXES.issuperset(node.attr) and len(node.attr) > 1:
        return (len(node.attr),)
    path = member_path(script, node)
    if path == "mathutils.Matrix.translation":
        return (3,)
    symbol = script.api.symbols.symbol(path) if path else None
    return symbol.array if symbol else ()


def _of_operation(script: Script, node: ast.BinOp, depth: int) -> Size:
    left, right = size_of(script, node.left, depth), size_of(script, node.right, depth)
    match left, right:
        case (rows, _), (_, columns):
            return (rows, columns) if isinstance(node.op, ast.MatMult) else left
        case (_, _), (count,):
            return (count,)
        case (count,), (_, _):
            return (count,)
        case _:
            return () if isinstance(node.op, ast.MatMult) else left or right


def are_refused(sign: str, left: Size, right: Size) -> bool:
    """Whether mathutils refuses to compute with vectors and matrices of these sizes; what it refuses of any size is not
    looked at. A matrix of four columns takes vectors of three components.
    """
    if sign != "@":
        return len(left) == len(right) and left != right
    match left, right:
        case (_, columns), (rows, _):
            return columns != rows
        case ((_, long), (count,)) | ((count,), (long, _)):
            return count not in ({3, 4} if long == _MOST else {long})
        case _:
            return left != right


def in_words(size: Size) -> str:
    """``a vector of 3 components``, ``a matrix of 4 × 4``."""
    return f"a vector of {size[0]} components" if len(size) == 1 else f"a matrix of {counted(size)}"


def counted(size: Size) -> str:
    """``4 × 4``."""
    return " × ".join(map(str, size))
