"""Vectors, matrices and buffers whose sizes do not fit, or that lack what is read from them.

```python
rotation.to_matrix() @ Matrix.Translation(offset)  # reported: 3 × 3 and 4 × 4
rotation.to_matrix().to_4x4() @ Matrix.Translation(offset)
uv.co - vertex.co  # reported: 2 and 3 components
Vector((1, 2, 3)).w  # reported
x, y = ob.location  # reported: 3 components
red, green, blue = ob.color  # reported: 4 numbers
ob.location[:] = (1, 2)  # reported: 3 numbers
ob.location.xy = (1, 2, 3)  # reported: 2 numbers
Matrix.Identity(5)  # reported: 2 to 4
mesh.vertices.foreach_get("co", np.zeros(len(mesh.vertices)))  # reported: 3 numbers for each
mesh.vertices.foreach_set("co", [(0, 0, 0), (1, 0, 0)])  # reported: it takes one row of numbers
fcurve.keyframe_points.foreach_set("interpolation", ["LINEAR"] * count)  # reported: it takes no texts
```

Not reported: sizes that are not written in the script or told by the API, scripts that resize any, and what stands in a
``try``.
"""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Tuple, members
from kb_check.calls.resolved import callee_path
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.syntax.annotated import ONE_IS_WRONG, annotated
from kb_check.syntax.literals import number
from kb_check.values.buffers import buffer_of_rows, buffer_of_texts, short_buffer
from kb_check.values.lengths import length_of, sliced
from kb_check.values.mathutils_sizes import (
    MATRIX,
    QUATERNION,
    SIZED,
    VECTOR,
    are_refused,
    counted,
    in_words,
    size_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script
    from kb_check.values.buffers import Rows
    from kb_check.values.mathutils_sizes import Size

_SIGNS: dict[type[ast.operator], str] = {ast.MatMult: "@", ast.Add: "+", ast.Sub: "-", ast.Mult: "*"}
_AXES = "xyzw"
_READ = re.compile(rf"[{_AXES}]+|translation")  # what a vector or a matrix of some sizes lacks
_SHOWN = 60  # characters of code that a sentence has room for
_SPACE = 3  # components of what is in space
_ROTATION, _WHOLE = (3, 3), (4, 4)
_SIZES = range(2, 5)
_ROWS = ("tuple", "Tuple")  # in annotations
# Methods of matrices, and the sizes that they work on.
_WANT = {
    "mathutils.Matrix.decompose": {_WHOLE}, "mathutils.Matrix.to_translation": {_WHOLE},
    "mathutils.Matrix.to_euler": {_ROTATION, _WHOLE}, "mathutils.Matrix.to_quaternion": {_ROTATION, _WHOLE},
}  # fmt: skip
# Methods of vectors that want another of the same size.
_ALIKE = frozenset(f"{VECTOR}.{name}" for name in ("angle", "cross", "dot", "project"))


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.BinOp, ast.AugAssign, ast.Attribute, ast.Call, ast.Assign, ast.Subscript):
        match node:
            case ast.BinOp(left=left, right=right) | ast.AugAssign(target=left, value=right):
                told = _operation(script, node, left, right)
            case ast.Attribute():
                told = _member(script, node)
            case ast.Call():
                told = _call(script, node) or _buffer(script, node)
            case ast.Subscript():
                told = _item(script, node)
            case ast.Assign(targets=[ast.Tuple(elts=names) | ast.List(elts=names)]):
                told = _unpacked(script, node.value, names)
            case ast.Assign(targets=[ast.Subscript() | ast.Attribute() as part]):
                told = _part_set(script, part, node.value)
            case _:
                continue
        if told and not is_tried(script, node):
            yield told


def _operation(
    script: Script, node: ast.BinOp | ast.AugAssign, left: ast.expr, right: ast.expr
) -> Finding | None:
    sign = _SIGNS.get(type(node.op), "")
    if not sign:
        return None
    first, second = size_of(script, left), size_of(script, right)
    if first and second and are_refused(sign, first, second):
        told = (
            f"`{sign}` is refused: {in_words(first)} does not fit {in_words(second)}.{_advice(first, second)}"
        )
        return _finding(script, node, told, fix=_widened(script, left, first, right, second))
    is_turned = sign == "@" and script.class_of(left) == QUATERNION and len(second) == 1
    if is_turned and second != (_SPACE,):
        told = f"A quaternion turns vectors of {_SPACE} components, and this one has {second[0]}."
        return _finding(script, node, told)
    return None


def _advice(first: Size, second: Size) -> str:
    match first, second:
        case (_, _), (_, _):
            return " `.to_4x4()` and `.to_3x3()` make one of the other."
        case (_,), (_,):
            return " `.to_3d()` and `.to_2d()` make one of the other."
        case _:
            return ""


def _widened(script: Script, left: ast.expr, first: Size, right: ast.expr, second: Size) -> Fix | None:
    """The fix that makes a transformation of a rotation, where the other one is one."""
    if sorted((first, second)) != [_ROTATION, _WHOLE]:
        return None
    small = left if first == _ROTATION else right
    if not isinstance(small, (ast.Name, ast.Attribute, ast.Call)):
        return None
    span = script.span(small)
    return Fix("Write .to_4x4()", (Edit(span, f"{script.text(span)}.to_4x4()"),))


def _member(script: Script, node: ast.Attribute) -> Finding | None:
    if not _READ.fullmatch(node.attr):
        return None
    size = size_of(script, node.value)
    if len(size) == 1 and set(node.attr) <= set(_AXES):
        lacking = [axis for axis in node.attr if _AXES.index(axis) >= size[0]]
        if lacking:
            return _finding(script, node, f"A vector of {size[0]} components has no `{lacking[0]}`.")
    if len(size) == 2 and node.attr == "translation" and size != _WHOLE:
        return _finding(
            script, node, f"{in_words(size).capitalize()} has no translation: one of 4 × 4 has.", MATRIX
        )
    return None


def _call(script: Script, call: ast.Call) -> Finding | None:
    path = callee_path(script, call)
    if path in SIZED and len(call.args) > SIZED[path]:
        return _made(script, call.args[SIZED[path]], path)
    if not isinstance(call.func, ast.Attribute) or path not in _ALIKE | _WANT.keys():
        return None
    size = size_of(script, call.func.value)
    if path in _WANT and size and size not in _WANT[path]:
        wanted = " or ".join(map(counted, sorted(_WANT[path])))
        return _finding(script, call, f"`{path}` wants a matrix of {wanted}, not of {counted(size)}.", path)
    other = size_of(script, call.args[0]) if path in _ALIKE and len(call.args) == 1 else ()
    if size and other and (other < size or (path.endswith("cross") and other != size)):
        return _finding(
            script, call, f"`{path}` wants {size[0]} components, and this vector has {other[0]}.", path
        )
    return None


def _buffer(script: Script, call: ast.Call) -> Finding | None:
    if rows := buffer_of_rows(script, call):
        return _of_rows(script, call, rows)
    if (texts := buffer_of_texts(script, call)) is not None:
        path = callee_path(script, call)
        told = f"`{path}` takes numbers, no texts: an enumeration is set on each item, or by the numbers of its values."
        return _finding(script, texts, told, path)
    if (short := short_buffer(script, call)) is None:
        return None
    rows = ", of which the rows count: `.ravel()` makes one row" if short.has_rows else ""
    told = f"`{short.path}` has {short.wanted} numbers for each, and this buffer has room for {short.given}{rows}."
    return _finding(script, call.args[1], told, short.path)


def _of_rows(script: Script, call: ast.Call, rows: Rows) -> Finding:
    row = "{}.ravel()" if rows.is_array else "[number for row in {} for number in row]"
    text = script.text(script.span(rows.buffer))
    shown = row.format(text if len(text) <= _SHOWN and "\n" not in text else "…")
    path = callee_path(script, call)
    told = f"`{path}` takes one row of numbers, and these are rows of their own: `{shown}`."
    gets_list = not rows.is_array and path.endswith("get")  # and would fill another one
    fix = (
        None
        if gets_list
        else Fix("Write one row of numbers", (Edit(script.span(rows.buffer), row.format(text)),), sure=True)
    )
    return _finding(script, rows.buffer, told, path, fix)


def _made(script: Script, node: ast.expr, path: str) -> Finding | None:
    count = number(script, node)
    if not isinstance(count, int) or count in _SIZES:
        return None
    return _finding(script, node, f"`{path}` makes matrices of 2 to 4 rows, not {count}.", path)


def _item(script: Script, node: ast.Subscript) -> Finding | None:
    place = number(script, node.slice)
    size = size_of(script, node.value) if isinstance(place, int) else ()
    if not size or not isinstance(place, int) or -size[0] <= place < size[0]:
        return None
    return _finding(script, node, f"{in_words(size).capitalize()} has no item {place}.")


def _unpacked(script: Script, value: ast.expr, names: list[ast.expr]) -> Finding | None:
    length = length_of(script, value)
    if length is None or len(names) == length or any(isinstance(name, ast.Starred) for name in names):
        return None
    size = size_of(script, value)
    kinds = members(script.type_of(value) or UNKNOWN)
    if any(isinstance(kind, Tuple) for kind in kinds) and _is_of_blender(script, value):
        return None  # wrong-count names what the call gives
    told = in_words(size).capitalize() if size else f"A row of {length}"
    told += f" cannot be unpacked into {len(names)} names"
    if any(annotated(script, value, name) for name in _ROWS):
        return replace(_finding(script, value, f"{told}: {ONE_IS_WRONG}."), severity="warning")
    return _finding(script, value, f"{told}.")


def _is_of_blender(script: Script, value: ast.expr) -> bool:
    return isinstance(value, ast.Call) and bool(callee_path(script, value))


def _part_set(script: Script, part: ast.Subscript | ast.Attribute, value: ast.expr) -> Finding | None:
    """What is wrong with setting several components of a vector, or a row of a matrix, at once."""
    whole, cls = part.value, script.class_of(part.value)
    wanted = None
    takes_more = False
    match part:
        case ast.Subscript(slice=ast.Slice() as bounds):
            length = length_of(script, whole) if cls else None
            wanted = None if length is None else sliced(script, bounds, length)
            takes_more = cls == VECTOR  # and leaves what is too much
        case ast.Subscript() if cls == MATRIX:
            wanted = length_of(script, part)
        case ast.Attribute(attr=name) if cls == VECTOR and len(name) > 1 and set(name) <= set(_AXES):
            wanted = len(name)
        case _:
            pass
    if wanted is None:
        return None
    given = length_of(script, value)
    if given is None or given == wanted or (takes_more and given > wanted):
        return None
    return _finding(script, value, f"`{ast.unparse(part)}` takes {wanted} numbers, not {given}.")


def _finding(
    script: Script, node: ast.expr | ast.stmt, told: str, path: str = "", fix: Fix | None = None
) -> Finding:
    return Finding(RULE.id, "error", script.span(node), told, path or VECTOR, (), fix)


RULE = Rule("wrong-size", "error", "Vectors, matrices and buffers whose sizes do not fit", _check)
