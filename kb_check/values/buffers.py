"""Buffers for ``foreach_get`` and ``foreach_set`` that surely are too short, or of something else than they take.

All parts of all items go into one row.

```python
image.pixels.foreach_set(np.ones(len(image.pixels)))  # of 64 bits
count = len(mesh.vertices)
mesh.vertices.foreach_get("co", np.zeros(count))  # 3 numbers each
mesh.vertices.foreach_get("co", np.zeros((count, 3)))  # only the rows count
mesh.vertices.foreach_set("co", [vertex.co for vertex in vertices])  # vectors in place of numbers
points.foreach_set("interpolation", ["LINEAR"] * count)  # texts in place of numbers
```
"""

from __future__ import annotations

import ast
from math import prod
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import ELEMENT
from kb_build.flow.values.types import (
    FLOAT,
    UNKNOWN,
    Collection,
    Instance,
    Plain,
    Sequence,
    Tuple,
    Union,
    members,
)
from kb_build.symbols.api_names import COLLECTION
from kb_check.calls.resolved import callee_path
from kb_check.syntax.bindings import once_bound
from kb_check.syntax.literals import number, times_bound
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_FUNCTIONS = frozenset({"foreach_get", "foreach_set"})
_MAKING = frozenset({"empty", "full", "ones", "zeros"})  # of numpy, by the shape that comes first
_CONVERTING = frozenset({"array", "asarray"})
_OF_COLOR = 4
_OF_DOUBLES = frozenset({"empty", "ones", "zeros"})  # unless they are told otherwise
_DOUBLES = frozenset({"float", "np.float64", "numpy.float64", "'float64'", "np.double", "'d'"})
_SINGLES = frozenset({"np.float32", "numpy.float32", "'float32'", "np.single", "'f'"})
_DTYPES = {"boolean": "bool", "int": "int"}  # of the properties that take no floats
_OF_ITEMS = frozenset(f"{owner}.{name}" for owner in (ARRAY, COLLECTION) for name in _FUNCTIONS)
_ROWS = frozenset(f"mathutils.{name}" for name in ("Color", "Euler", "Quaternion", "Vector"))
_RESIZING = frozenset({"append", "extend", "insert", "resize", "shape"})


class Short(NamedTuple):
    """How many numbers an item has, how many there are in the buffer for each, and the path of the property."""

    wanted: int
    given: int
    path: str
    has_rows: bool


def short_buffer(script: Script, call: ast.Call) -> Short | None:
    """What is too short of the buffer that a call is given; None where it may be long enough."""
    match call:
        case ast.Call(func=ast.Attribute(value=items, attr=name), args=[attribute, buffer]) if (
            name in _FUNCTIONS and callee_path(script, call)
        ):
            pass
        case _:
            return None
    wanted, path = _numbers_of(script, items, attribute)
    shape = _shape(script, buffer)
    length = shape.elts[0] if isinstance(shape, ast.Tuple) and shape.elts else shape
    given = _times(script, length, ast.unparse(items)) if length else None
    if given is None or given >= wanted or not _stays(script, items, buffer):
        return None
    return Short(wanted, given, path, length is not shape)


def _numbers_of(script: Script, items: ast.expr, attribute: ast.expr) -> tuple[int, str]:
    """How many numbers an item of a collection has of the property that a text names, and its path; 0 for unknown."""
    kind = script.type_of(items)
    element = kind.element if isinstance(kind, Collection) else None
    if not isinstance(element, Instance) or not isinstance(attribute, ast.Constant):
        return 0, ""
    member = script.api.member(element.cls, str(attribute.value))
    array = member.symbol.array if member else ()
    return (prod(array), member.symbol.path) if member and array and all(array) else (0, "")


def _shape(script: Script, buffer: ast.expr) -> ast.expr | None:
    """The expression for the number of a buffer's items, or for its rows and columns."""
    match once_bound(script, buffer):
        case ast.Call(func=ast.Attribute(value=ast.Name(id="np" | "numpy"), attr=name), args=[shape, *_]) if (
            name in _MAKING
        ):
            return shape
        case ast.BinOp(left=ast.List(elts=[_]), op=ast.Mult(), right=length):
            return length
        case _:
            return None


def _times(script: Script, length: ast.expr, items: str) -> int | None:
    """How many times the length of a collection an expression is; None where that cannot be seen."""
    match once_bound(script, length):
        case ast.Call(func=ast.Name(id="len"), args=[collection]) if ast.unparse(collection) == items:
            return 1
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            for one, other in ((left, right), (right, left)):
                factor, times = number(script, one), _times(script, other, items)
                if isinstance(factor, int) and times is not None:
                    return factor * times
            return None
        case _:
            return None


def _stays(script: Script, items: ast.expr, buffer: ast.expr) -> bool:
    """Whether the names in both stand for one thing each, and nothing makes the buffer longer."""
    names = {node.id for part in (items, buffer) for node in ast.walk(part) if isinstance(node, ast.Name)}
    return not _is_changed(script, names, _RESIZING) and all(times_bound(script)[name] <= 1 for name in names)


def _is_changed(script: Script, names: set[str], by: Iterable[str]) -> bool:
    """Whether something of these names is called, or set, on one of the names, or added to it in place."""
    return any(
        isinstance(node.value, ast.Name) and node.value.id in names
        for name in by
        for node in attributes(script).get(name, ())
    ) or any(
        isinstance(node.target, ast.Name) and node.target.id in names for node in script.all(ast.AugAssign)
    )


class Rows(NamedTuple):
    """A buffer of vectors, tuples or lists in place of numbers, and whether it is an array of numpy."""

    buffer: ast.expr
    is_array: bool


def buffer_of_rows(script: Script, call: ast.Call) -> Rows | None:
    """The buffer that a call is given, if it surely has rows in place of numbers."""
    match call:
        case ast.Call(
            func=ast.Attribute(value=items, attr=name), args=[*attributes, buffer], keywords=[]
        ) if name in _FUNCTIONS and callee_path(script, call) in _OF_ITEMS:
            pass
        case _:
            return None
    if _is_of_rows(script, buffer):
        return Rows(buffer, is_array=False)
    # An array of numpy goes by the number of its rows, which may be right where each item is one number.
    wanted = _numbers_of(script, items, attributes[0])[0] if attributes else _OF_COLOR
    made = once_bound(script, buffer)
    has_rows = wanted > 1 and isinstance(made, ast.Call) and _makes_rows(script, made, wanted)
    return Rows(buffer, is_array=True) if has_rows and _stays(script, items, buffer) else None


def buffer_of_texts(script: Script, call: ast.Call) -> ast.expr | None:
    """The buffer that a call is given, if it surely holds texts in place of numbers."""
    match call:
        case ast.Call(func=ast.Attribute(attr=name), args=[_, buffer], keywords=[]) if (
            name in _FUNCTIONS and callee_path(script, call) in _OF_ITEMS
        ):
            return buffer if all(map(_holds_texts, members(script.type_of(buffer) or UNKNOWN))) else None
        case _:
            return None


def _holds_texts(kind: Type) -> bool:
    match kind:
        case Sequence(kind="list" | "tuple", element=element):
            items = members(element)
        case Tuple(items=items):
            pass
        case _:
            return False
    return bool(items) and all(isinstance(item, Plain) and item.kind == "str" for item in items)


def _makes_rows(script: Script, call: ast.Call, wanted: int) -> bool:
    """Whether a call of numpy makes an array of rows, each of the numbers of one item."""
    match call:
        case ast.Call(func=ast.Attribute(value=ast.Name(id="np" | "numpy"), attr=name), args=[first, *_]) if (
            all(keyword.arg == "dtype" for keyword in call.keywords)
        ):
            pass
        case _:
            return False
    match first:
        case ast.Tuple(elts=[_, *_, last]) if name in _MAKING:
            return number(script, last) == wanted
        case _:
            return name in _CONVERTING and _is_of_rows(script, first)


def _is_of_rows(script: Script, buffer: ast.expr) -> bool:
    kind = script.type_of(buffer)
    return kind is not None and all(map(_holds_rows, members(kind)))


def _holds_rows(kind: Type) -> bool:
    match kind:
        case Tuple(items=items):
            return bool(items) and all(_is_row(item) for item in items)
        case Sequence(kind="list" | "tuple", element=Union(members=members)):
            return all(_is_row(member) for member in members)
        case Sequence(kind="list" | "tuple", element=element):
            return _is_row(element)
        case _:
            return False


def _is_row(kind: Type) -> bool:
    match kind:
        case Tuple() | Sequence():
            return True
        case Instance(cls=cls, sure=sure):
            return sure and cls in _ROWS
        case _:
            return False


def wide_buffer(script: Script, call: ast.Call) -> ast.Call | None:
    """The call of numpy that makes the buffer which an array's own ``foreach_get`` or ``foreach_set`` is given, if its
    floats have 64 bits. An array of Blender takes those of 32 bits alone; its collections take both.
    """
    match call:
        case ast.Call(func=ast.Attribute(value=array, attr=name), args=[buffer], keywords=[]) if (
            name in _FUNCTIONS and callee_path(script, call) == f"{ARRAY}.{name}"
        ):
            source = once_bound(script, buffer)
        case _:
            return None
    is_wide = isinstance(source, ast.Call) and _makes_doubles(source) and _element(script, array) == FLOAT
    return source if isinstance(source, ast.Call) and is_wide else None


class Floats(NamedTuple):
    """A buffer of floats, the path of the property that takes none, and what makes numbers that it takes."""

    buffer: ast.expr
    path: str
    dtype: str


def float_buffer(script: Script, call: ast.Call) -> Floats | None:
    """The buffer that ``foreach_set`` of a collection is given, if it surely holds floats for a property of ints or
    truth values: Blender turns none into these.
    """
    match call:
        case ast.Call(
            func=ast.Attribute(value=items, attr="foreach_set"),
            args=[ast.Constant(value=str(attribute)), buffer],
            keywords=[],
        ) if callee_path(script, call) == f"{COLLECTION}.foreach_set":
            kind = script.type_of(items)
        case _:
            return None
    element = kind.element if isinstance(kind, Collection) else None
    member = script.api.member(element.cls, attribute) if isinstance(element, Instance) else None
    dtype = _DTYPES.get(member.symbol.type) if member else None
    if member is None or dtype is None or not _holds_floats(script, buffer):
        return None
    return Floats(once_bound(script, buffer), member.symbol.path, dtype)


def _holds_floats(script: Script, buffer: ast.expr) -> bool:
    made = once_bound(script, buffer)
    if isinstance(made, ast.Call):
        return _makes_doubles(made) or _makes_singles(made)
    match script.type_of(buffer):
        case Sequence(kind="list" | "tuple", element=Plain(kind="float")):
            return True
        case Tuple(items=parts) if parts:
            return all(isinstance(part, Plain) and part.kind == "float" for part in parts)
        case _:
            return False


def _makes_singles(call: ast.Call) -> bool:
    """Whether a call surely makes an array of numpy of floats of 32 bits."""
    match call:
        case ast.Call(
            func=ast.Attribute(value=ast.Name(id="np" | "numpy"), attr=name),
            args=[_],
            keywords=[ast.keyword(arg="dtype", value=kind)],
        ):
            return name in _OF_DOUBLES and ast.unparse(kind) in _SINGLES
        case _:
            return False


def _element(script: Script, array: ast.expr) -> Type | None:
    """What an array of Blender holds, where that is known."""
    match script.type_of(array):
        case Sequence(element=element):
            return element
        case Instance() as kind:
            return kind.trait(ELEMENT)
        case _:
            return None


def _makes_doubles(call: ast.Call) -> bool:
    """Whether a call surely makes an array of numpy of floats of 64 bits."""
    match call:
        case ast.Call(func=ast.Attribute(value=ast.Name(id="np" | "numpy"), attr=name), args=[_]) if (
            name in _OF_DOUBLES
        ):
            kinds = [keyword.value for keyword in call.keywords if keyword.arg == "dtype"]
            return len(call.keywords) == len(kinds) and all(ast.unparse(kind) in _DOUBLES for kind in kinds)
        case ast.Call(
            func=ast.Attribute(
                value=ast.Attribute(value=ast.Name(id="np" | "numpy"), attr="random"), attr=name
            )
        ):
            return name in {"rand", "random"} and not call.keywords
        case _:
            return False
