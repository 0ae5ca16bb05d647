"""Reads the types that Blender's docstrings and signatures spell out: ``list[bmesh.types.BMVert] | None``."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import (
    BOOL,
    FLOAT,
    INT,
    NONE,
    STR,
    UNKNOWN,
    Instance,
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
    "str": STR, "string": STR, "int": INT, "float": FLOAT, "bool": BOOL, "boolean": BOOL, "bytes": Plain("bytes"),
    "None": NONE, "enum": STR,
}  # fmt: skip
_LISTS = {
    "list": "list", "List": "list", "Sequence": "list", "set": "set", "frozenset": "set", "Iterator": "iterator",
    "Iterable": "iterator", "Generator": "iterator",
}  # fmt: skip
_LIST_OF = re.compile(r"^(?:[Ll]ist|[Ss]equence|[Tt]uple) of ([\w.]+)$")
# ``BMLayerCollection of BMLoopUV``, as references wrote it until 5.0.
_CLASS_OF = re.compile(r"([\w.]+) of ([\w.]+)")
_MAPPINGS = frozenset({"dict", "Mapping", "Dict"})


def read_type(text: str, class_named: Callable[[str], str]) -> Type:
    """The type that a text spells; UNKNOWN for what it does not.

    ``class_named`` returns the path of the class that a name means, empty for none.
    """
    if text in _PLAIN:
        return _PLAIN[text]
    if found := _LIST_OF.match(text):
        return Sequence("list", read_type(found[1], class_named))
    if found := _CLASS_OF.fullmatch(text):
        text = f"{found[1]}[{found[2]}]"
    try:
        tree = ast.parse(text, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return UNKNOWN
    return _read(tree.body, class_named)


def _read(node: ast.expr, class_named: Callable[[str], str]) -> Type:  # noqa: PLR0911 - one return a form
    match node:
        case ast.Name() | ast.Attribute():
            name = ast.unparse(node)
            if name in _PLAIN:
                return _PLAIN[name]
            if cls := class_named(name):  # also of strips, which were called Sequence until 4.5
                return Instance(cls)
            return Sequence(_LISTS[name], UNKNOWN) if name in _LISTS else UNKNOWN
        case ast.Constant(value=None):
            return NONE
        case ast.BinOp(op=ast.BitOr()):
            return union((_read(node.left, class_named), _read(node.right, class_named)))
        case ast.Subscript():
            return _generic(node, class_named)
        case _:
            return UNKNOWN


def _generic(node: ast.Subscript, class_named: Callable[[str], str]) -> Type:  # noqa: PLR0911 - likewise
    head = ast.unparse(node.value)
    last = head.rpartition(".")[2]
    inside = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    if isinstance(inside[0], ast.Constant) and isinstance(inside[0].value, int):  # ``float[3]``
        return Sequence("array", _PLAIN.get(head, UNKNOWN))
    if last == "Literal":
        return (
            STR if all(isinstance(i, ast.Constant) and isinstance(i.value, str) for i in inside) else UNKNOWN
        )
    if last == "Optional":
        return union((_read(inside[0], class_named), NONE))
    if last in {"tuple", "Tuple"}:
        if len(inside) == 2 and isinstance(inside[1], ast.Constant) and inside[1].value is ...:
            return Sequence("tuple", _read(inside[0], class_named))
        return Tuple(tuple(_read(item, class_named) for item in inside))
    if last in _MAPPINGS and len(inside) == 2:
        return Mapping(_read(inside[0], class_named), _read(inside[1], class_named))
    element = _read(inside[0], class_named)
    if last in _LISTS:
        return Sequence(_LISTS[last], element)
    cls = class_named(head)
    # ``BMLayerCollection[BMLoopUV]``: a class of its own, which knows what it holds.
    return Instance(cls, (("[]", element),)) if cls else UNKNOWN
