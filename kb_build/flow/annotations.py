"""What annotations in a script mean."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.trees import walk
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
    "str": STR, "int": INT, "bool": BOOL, "bytes": Plain("bytes"), "None": NONE,
    "float": union((FLOAT, INT)),  # as for type checkers
}  # fmt: skip
_LISTS = {
    "list": "list", "List": "list", "Sequence": "list", "set": "set", "Set": "set", "frozenset": "set",
    "Iterable": "iterator", "Iterator": "iterator", "Collection": "list",
}  # fmt: skip
_DEEPEST = 20
_LONGEST = 10_000  # characters of a quoted annotation
_QUOTES = frozenset({1, 3})


@dataclass(frozen=True, slots=True)
class Readers:
    """What gives an annotation its meaning: the classes that names stand for, and what a quoted one says."""

    evaluate: Callable[[ast.expr], Type]
    quoted: Callable[[ast.Constant], Type]


def unquoted(node: ast.Constant) -> ast.expr | None:
    """What a quoted annotation says, in its place in the script; None for what cannot be read.

    Where its text is not written as it is read, each part has the place of the whole.
    """
    text = node.value
    if not isinstance(text, str) or len(text) > _LONGEST:
        return None
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    quotes, odd = divmod((node.end_col_offset or 0) - node.col_offset - len(text.encode()), 2)
    is_plain = node.lineno == node.end_lineno and not odd and quotes in _QUOTES and "\\" not in text
    for part in walk(tree):
        if not is_plain:
            ast.copy_location(part, node)
        elif isinstance(part, (ast.expr, ast.keyword)):
            part.lineno = part.end_lineno = node.lineno
            part.col_offset += node.col_offset + quotes
            part.end_col_offset = (part.end_col_offset or 0) + node.col_offset + quotes
    return tree


def annotated(node: ast.expr, readers: Readers, depth: int = 0) -> Type:  # noqa: PLR0911 - one return a form
    """The type of a value with this annotation."""
    if depth > _DEEPEST:
        return UNKNOWN
    match node:
        case ast.Constant(value=None):
            return NONE
        case ast.Constant(value=str()):
            return readers.quoted(node)
        case ast.BinOp(op=ast.BitOr()):
            return union(annotated(side, readers, depth + 1) for side in (node.left, node.right))
        case ast.Subscript():
            return _generic(node, readers, depth + 1)
        case ast.Name(id=name) if name in _PLAIN:
            return _PLAIN[name]
        case ast.Name(id=name) if name in _LISTS:
            return Sequence(_LISTS[name], UNKNOWN)
        case ast.Name() | ast.Attribute():
            kind = readers.evaluate(node)
            if isinstance(kind, ClassObject):
                return Instance(kind.cls)
            return LocalInstance(kind.number) if isinstance(kind, LocalClass) else UNKNOWN
        case _:
            readers.evaluate(node)
            return UNKNOWN


def _generic(node: ast.Subscript, readers: Readers, depth: int) -> Type:  # noqa: PLR0911 - one return a form
    head = node.value
    name = head.id if isinstance(head, ast.Name) else head.attr if isinstance(head, ast.Attribute) else ""
    inside = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    if not inside:
        return UNKNOWN
    if name == "Optional":
        return union((annotated(inside[0], readers, depth), NONE))
    if name == "Union":
        return union(annotated(item, readers, depth) for item in inside)
    if name in _LISTS:
        return Sequence(_LISTS[name], annotated(inside[0], readers, depth))
    if name in {"tuple", "Tuple"}:
        if isinstance(inside[-1], ast.Constant) and inside[-1].value is ...:
            return Sequence("tuple", annotated(inside[0], readers, depth))
        return Tuple(tuple(annotated(item, readers, depth) for item in inside))
    if name in {"dict", "Dict", "Mapping"} and len(inside) == 2:
        key, value = (annotated(item, readers, depth) for item in inside)
        return Mapping(key, value)
    readers.evaluate(node)
    return UNKNOWN
