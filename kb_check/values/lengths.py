"""How many items a value surely has that is given to an array, or unpacked.

========================================  ==========================================================
value                                     how many
========================================  ==========================================================
a tuple or a list that is written out     its items, also behind a star, ``*`` and ``+``
a name                                    the items of all that it can hold
a vector, a color, a rotation             its components
a property that holds an array            its size
a row or a column of a matrix             as many as it has columns, or rows
``colorsys.hsv_to_rgb()``                 three
========================================  ==========================================================
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.values.types import UNKNOWN, Instance, Tuple, members
from kb_check.calls.resolved import builtin_called, member_path
from kb_check.syntax.literals import number
from kb_check.values.documented import LENGTHS
from kb_check.values.mathutils_sizes import size_of

if TYPE_CHECKING:
    from kb_check.script import Script

# Arrays whose size is not the one that RNA declares.
CHANGING_ARRAYS = frozenset({"bpy.types.FModifierGenerator.coefficients", "bpy.types.MeshPolygon.vertices"})
_DEEPEST = 8
_COPYING = frozenset({"list", "tuple"})
_ENDLESS = frozenset({"enumerate", "filter", "iter", "map", "reversed", "zip"})  # without a length
_OF_COLORS = frozenset(
    f"{one}_to_{other}"
    for pair in (("rgb", "hls"), ("rgb", "hsv"), ("rgb", "yiq"))
    for one, other in (pair, pair[::-1])
)
_OF_COLOR = 3


def length_of(  # noqa: PLR0911 - one return an expression
    script: Script, node: ast.expr, depth: int = _DEEPEST
) -> int | None:
    """How many items an expression surely gives; None where that is not known, or not one number."""
    if not depth:
        return None
    match node:
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return _sum_of([_of_part(script, part, depth - 1) for part in parts])
        case ast.BinOp(left=left, op=ast.Add(), right=right) if _is_row(script, left, depth - 1):
            return _sum_of([length_of(script, side, depth - 1) for side in (left, right)])
        case ast.BinOp(left=left, op=ast.Mult(), right=right) if isinstance(left, (ast.List, ast.Tuple)):
            once, times = length_of(script, left, depth - 1), number(script, right)
            return once * max(times, 0) if once is not None and isinstance(times, int) else None
        case ast.Call(args=[copied], keywords=[]) as call if builtin_called(script, call) in _COPYING:
            return length_of(script, copied, depth - 1)
        case ast.Call(args=bounds) as call if builtin_called(script, call) == "range":
            return _of_range(script, bounds)
        case ast.Call(func=ast.Attribute(value=ast.Name(id="colorsys"), attr=name)) if name in _OF_COLORS:
            return _OF_COLOR
        case ast.Subscript(value=whole, slice=ast.Slice() as part):
            length = length_of(script, whole, depth - 1)
            return None if length is None else sliced(script, part, length)
        case ast.Subscript(value=whole) if (size := _of_line(script, whole)) is not None:
            return size
        case _:
            return _of_value(script, node)


def sliced(script: Script, part: ast.Slice, length: int) -> int | None:
    """How many of so many items a slice takes; None where its bounds are computed."""
    bounds = [None if bound is None else number(script, bound) for bound in (part.lower, part.upper)]
    is_open = any(
        bound is not None and not isinstance(value, int)
        for bound, value in zip((part.lower, part.upper), bounds, strict=True)
    )
    if is_open or part.step is not None:
        return None
    first, last = (value if isinstance(value, int) else None for value in bounds)
    return len(range(length)[first:last])


def is_iterator(script: Script, node: ast.expr) -> bool:
    """Whether a value surely has no length: what a generator or ``map`` gives."""
    match node:
        case ast.GeneratorExp():
            return True
        case ast.Call() as call:
            return builtin_called(script, call) in _ENDLESS
        case _:
            return False


def _of_range(script: Script, bounds: list[ast.expr]) -> int | None:
    known = [value for bound in bounds if isinstance(value := number(script, bound), int)]
    is_known = len(known) == len(bounds) and 0 < len(bounds) < len(("first", "end", "step"))
    return len(range(*known)) if is_known else None


def _of_part(script: Script, node: ast.expr, depth: int) -> int | None:
    return length_of(script, node.value, depth) if isinstance(node, ast.Starred) else 1


def _sum_of(lengths: list[int | None]) -> int | None:
    known = [length for length in lengths if length is not None]
    return sum(known) if len(known) == len(lengths) else None


def _is_row(script: Script, node: ast.expr, depth: int) -> bool:
    """Whether a value is a tuple or a list: what is added to one comes behind it."""
    match node:
        case ast.Tuple() | ast.List():
            return True
        case ast.Call(func=ast.Name(id=name)):
            return name in _COPYING
        case ast.Call(func=ast.Attribute(value=ast.Name(id="colorsys"))):
            return True
        case ast.BinOp(left=left, op=ast.Add() | ast.Mult()):
            return _is_row(script, left, depth - 1)
        case ast.Subscript(value=whole, slice=ast.Slice()):
            return script.class_of(whole) == ARRAY or _is_row(script, whole, depth - 1)
        case _:
            return all(isinstance(kind, Tuple) for kind in members(script.type_of(node) or UNKNOWN))


def _of_value(script: Script, node: ast.expr) -> int | None:
    """The length of what is not written out here, by its type."""
    kinds = members(script.type_of(node) or UNKNOWN)
    if all(isinstance(kind, Tuple) for kind in kinds):
        lengths = {len(kind.items) for kind in kinds if isinstance(kind, Tuple)}
        return lengths.pop() if len(lengths) == 1 else None
    match kinds:
        case (Instance(cls=cls, sure=True),) if cls in LENGTHS:
            return LENGTHS[cls]
        case (Instance(cls=cls, sure=True),):
            return _of_instance(script, node, cls)
        case _:
            return None


def _of_instance(script: Script, node: ast.expr, cls: str) -> int | None:
    size = size_of(script, node)
    if len(size) == 1:
        return size[0]
    path = member_path(script, node) if cls == ARRAY and isinstance(node, ast.Attribute) else ""
    symbol = script.api.symbols.symbol(path) if path and path not in CHANGING_ARRAYS else None
    return symbol.array[0] if symbol and len(symbol.array) == 1 and symbol.array[0] else None


def _of_line(script: Script, whole: ast.expr) -> int | None:
    """How many items each row of a matrix has, or each of its columns: ``matrix``, ``matrix.col``."""
    match whole:
        case ast.Attribute(value=matrix, attr="col" | "row" as side):
            size = size_of(script, matrix)
        case matrix:
            size, side = size_of(script, matrix), "row"
    return size[side == "row"] if len(size) == len(("rows", "columns")) else None
