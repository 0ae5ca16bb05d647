"""What operators give for the types of values: numbers, rows, and what mathutils computes."""

from __future__ import annotations

import ast
import operator as op
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.values.types import (
    BOOL,
    FLOAT,
    FROM_VERSION,
    INT,
    STR,
    UNKNOWN,
    Instance,
    Plain,
    Sequence,
    Tuple,
    Type,
    Union,
    join,
    literal,
    members,
    union,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from collections.abc import Sequence as Rows

_MATH = frozenset(
    {"mathutils.Vector", "mathutils.Color", "mathutils.Euler", "mathutils.Quaternion", "mathutils.Matrix"}
)
VECTOR = "mathutils.Vector"
SEQUENCE = "a sequence"  # of Python's, or of numbers that a property holds: mathutils computes with neither
_NUMBERS = frozenset({"bool", "int", "float"})
LONGEST_LITERAL = 64
_COMPARISONS: dict[type[ast.cmpop], Callable[[list[int], list[int]], bool]] = {
    ast.Lt: op.lt, ast.LtE: op.le, ast.Gt: op.gt, ast.GtE: op.ge, ast.Eq: op.eq, ast.NotEq: op.ne,
}  # fmt: skip
_MINOR = 2  # numbers of a version that tell what its API is


def comparison(left: Rows[Type], right: Rows[Type], operator: ast.cmpop) -> Type:
    """The comparison of two rows of numbers: how scripts ask for Blender's version."""
    first = [literal(kind) for kind in left]
    second = [literal(kind) for kind in right]
    if not all(isinstance(value, int) for value in (*first, *second)):
        return BOOL
    ours, theirs = [int(v) for v in first if v is not None], [int(v) for v in second if v is not None]
    compare = _COMPARISONS.get(type(operator))
    if compare is None or (isinstance(operator, (ast.Eq, ast.NotEq)) and len(ours) > _MINOR):
        return BOOL
    return Plain("bool", compare(ours, theirs), FROM_VERSION)


def is_math(kind: Type) -> bool:
    """Whether a type is one of mathutils' values that can be multiplied."""
    return isinstance(kind, Instance) and kind.cls in _MATH


def math_operand(kind: Type) -> str:
    """What a value is to mathutils: a class, ``number``, or what it never computes with; empty if it may be any."""
    if isinstance(kind, Plain):
        return "number" if kind.kind in _NUMBERS else kind.kind
    if isinstance(kind, Tuple) or (isinstance(kind, Instance) and kind.cls == ARRAY):
        return SEQUENCE
    return kind.cls if isinstance(kind, Instance) and kind.cls in _MATH else ""


def operation_type(left: Type, right: Type, operator: ast.operator) -> Type:  # noqa: PLR0911, PLR0912 - one return a rule
    """The type of what an operator gives for two values; UNKNOWN where that is not sure."""
    if isinstance(left, Union) or isinstance(right, Union):
        return union(operation_type(a, b, operator) for a in members(left)[:3] for b in members(right)[:3])
    if isinstance(left, Plain) and left.kind == "str":
        return STR
    if isinstance(left, Instance) and left.cls in _MATH:
        if isinstance(right, Instance) and right.cls in _MATH:
            if not isinstance(operator, ast.MatMult):
                return left
            if left.cls == VECTOR:
                return FLOAT if right.cls == VECTOR else left
            return right  # which a matrix or a rotation turns
        return (
            Instance(left.cls) if right is not UNKNOWN or not isinstance(operator, ast.MatMult) else UNKNOWN
        )
    if isinstance(right, Instance) and right.cls in _MATH and isinstance(left, Plain):
        return right
    if isinstance(left, Plain) and isinstance(right, Plain):
        if not {left.kind, right.kind} <= _NUMBERS:
            return STR if right.kind == "str" and isinstance(operator, ast.Mult) else UNKNOWN
        if isinstance(operator, ast.Div):
            return FLOAT
        if isinstance(operator, ast.Pow) and FLOAT.kind not in {left.kind, right.kind}:
            exponent = literal(right)
            return INT if isinstance(exponent, int) and exponent >= 0 else UNKNOWN
        if isinstance(operator, (ast.BitAnd, ast.BitOr, ast.BitXor)) and left.kind == right.kind:
            return Plain(left.kind)
        return FLOAT if "float" in {left.kind, right.kind} else INT
    if isinstance(operator, ast.Add):
        if isinstance(left, Tuple) and isinstance(right, Tuple):
            return Tuple((*left.items, *right.items)) if len(left.items) < LONGEST_LITERAL else UNKNOWN
        if isinstance(left, (Sequence, Tuple)) and isinstance(right, (Sequence, Tuple)):
            return Sequence("list", join(_element(left), _element(right)))
    if isinstance(operator, ast.Mult) and isinstance(left, (Sequence, Tuple)):
        return Sequence("list", _element(left))
    if isinstance(operator, (ast.BitOr, ast.BitAnd, ast.Sub)) and isinstance(left, Sequence):
        return left
    return UNKNOWN


def _element(kind: Sequence | Tuple) -> Type:
    return kind.element if isinstance(kind, Sequence) else union(kind.items)
