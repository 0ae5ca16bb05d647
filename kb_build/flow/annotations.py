"""What annotations in a script mean."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.types import (
    BOOL,
    FLOAT,
    INT,
    NONE,
    STR,
    UNKNOWN,
    ClassObject,
    Instance,
    LocalClass,
    LocalInstance,
    Mapping,
    Plain,
    Sequence,
    Tuple,
    Type,
    union,
)

if TYPE_CHECKING:
    from collections.abc import Callable

_PLAIN: dict[str, Type] = {
    "str": STR, "int": INT, "float": FLOAT, "bool": BOOL, "bytes": Plain("bytes"), "None": NONE,
}  # fmt: skip
_LISTS = {
    "list": "list", "List": "list", "Sequence": "list", "set": "set", "Set": "set", "frozenset": "set",
    "Iterable": "iterator", "Iterator": "iterator", "Collection": "list",
}  # fmt: skip
_DEEPEST = 20


def annotated(node: ast.expr, evaluate: Callable[[ast.expr], Type], depth: int = 0) -> Type:  # noqa: PLR0911 - one return a form
    """The type of a value with this annotation; ``evaluate`` gives the classes that names stand for."""
    if depth > _DEEPEST:
        return UNKNOWN
    match node:
        case ast.Constant(value=None):
            return NONE
        case ast.Constant(value=str() as text):
            try:
                tree = ast.parse(text, mode="eval")
            except (SyntaxError, ValueError, RecursionError, MemoryError):
                return UNKNOWN
            return annotated(tree.body, evaluate, depth + 1)
        case ast.BinOp(op=ast.BitOr()):
            return union(annotated(side, evaluate, depth + 1) for side in (node.left, node.right))
        case ast.Subscript():
            return _generic(node, evaluate, depth + 1)
        case ast.Name(id=name) if name in _PLAIN:
            return _PLAIN[name]
        case ast.Name(id=name) if name in _LISTS:
            return Sequence(_LISTS[name], UNKNOWN)
        case ast.Name() | ast.Attribute():
            kind = evaluate(node)
            if isinstance(kind, ClassObject):
                return Instance(kind.cls)
            return LocalInstance(kind.number) if isinstance(kind, LocalClass) else UNKNOWN
        case _:
            evaluate(node)
            return UNKNOWN


def _generic(node: ast.Subscript, evaluate: Callable[[ast.expr], Type], depth: int) -> Type:  # noqa: PLR0911 - one return a form
    head = node.value
    name = head.id if isinstance(head, ast.Name) else head.attr if isinstance(head, ast.Attribute) else ""
    inside = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    if not inside:
        return UNKNOWN
    if name == "Optional":
        return union((annotated(inside[0], evaluate, depth), NONE))
    if name == "Union":
        return union(annotated(item, evaluate, depth) for item in inside)
    if name in _LISTS:
        return Sequence(_LISTS[name], annotated(inside[0], evaluate, depth))
    if name in {"tuple", "Tuple"}:
        if isinstance(inside[-1], ast.Constant) and inside[-1].value is ...:
            return Sequence("tuple", annotated(inside[0], evaluate, depth))
        return Tuple(tuple(annotated(item, evaluate, depth) for item in inside))
    if name in {"dict", "Dict", "Mapping"} and len(inside) == 2:
        key, value = (annotated(item, evaluate, depth) for item in inside)
        return Mapping(key, value)
    evaluate(node)
    return UNKNOWN
