"""A product, a sum or a quotient of mathutils' values that it refuses, or that is hardly the one meant.

Matrices, quaternions and vectors are multiplied with ``@``; ``*`` goes item by item, and only between two of a kind.
Until 2.79 both were ``*``. A colour is multiplied by a number only, an Euler not at all: ``euler.to_matrix()`` is.

```python
ob.matrix_world * vertex.co  # reported
ob.matrix_world @ vertex.co
ob.location += (0, 0, 1)  # reported
ob.location += Vector((0, 0, 1))
ob.rotation_euler += (0, 0, 0.5)  # reported
ob.rotation_euler.z += 0.5
[ob.matrix_world @ corner for corner in ob.bound_box]  # reported: its corners are no vectors
[ob.matrix_world @ Vector(corner) for corner in ob.bound_box]
```

So is what is computed with None: `matrix.invert() @ vector`, for `matrix.inverted()`; and `sum(v.co for v in verts)`,
which begins with the number 0.

A vector is added to a vector only, and divided by a number only.

Two matrices or two quaternions are a warning: ``*`` of them works, and gives something else than it did until 2.79.

```python
ob.matrix_world * Matrix.Rotation(1, 4, "Z")  # a warning: multiplies item by item
ob.matrix_world @ Matrix.Rotation(1, 4, "Z")
```

Not reported: ``vector * vector``, which is often meant item by item.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import PRODUCTS
from kb_build.flow.values.types import Instance, Sequence, Tuple
from kb_build.symbols.paths import last_name
from kb_check.calls.resolved import builtin_called
from kb_check.calls.sites import nothing_from, other_way
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.values.mathutils_sizes import VECTOR

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_MATH = frozenset(f"mathutils.{name}" for name in ("Color", "Euler", "Matrix", "Quaternion", "Vector"))
_EULER = "mathutils.Euler"
_SEQUENCE, _NUMBER = "a sequence", "number"  # of Python's
_OF_EULER = (
    "An Euler is not computed with: change one of its angles (`euler.z += 0.5`), turn it by `euler.rotate(…)`, or "
    "take `euler.to_matrix()`."
)
_ADDED = frozenset({"mathutils.Color", "mathutils.Vector"})
_TRANSFORMS = frozenset({"mathutils.Matrix", "mathutils.Quaternion"})


def _check(script: Script) -> Iterator[Finding]:
    for row in (*script.missing("product"), *script.missing("sum")):
        left, right = row.missing[0], row.missing[-1]
        in_place = isinstance(row.node, ast.AugAssign)
        is_other = row.value in PRODUCTS and (left, right) in PRODUCTS["@"]
        fix = _fix(script, row.node) if is_other and isinstance(row.node, ast.BinOp) else None
        sign = f"{row.value}=" if in_place else row.value
        advice = _advice(str(row.value), left, right, in_place=in_place)
        yield Finding(
            RULE.id, "error", script.span(row.node), f"`{left} {sign} {right}` is refused. {advice}",
            left if left in _MATH else right, (), fix,
        )  # fmt: skip
    yield from _by_item(script)
    yield from _with_nothing(script)
    yield from _sums(script)


def _advice(sign: str, left: str, right: str, *, in_place: bool) -> str:
    """What to write instead of what is refused."""
    pair = {left, right}
    told = "Convert one of them first."
    if sign in PRODUCTS and (left, right) in PRODUCTS["@"]:
        in_full = "In place the result must be of the same class. Write `a = b @ a`."
        told = in_full if in_place else "Multiply them with `@`."
    elif _EULER in pair:
        told = _OF_EULER
    elif sign == "/":
        told = "Vectors and colors are divided by a number, nothing else is divided."
    elif _SEQUENCE in pair:
        told = f"Make one of the sequence: `{VECTOR if sign in PRODUCTS else next(iter(pair & _MATH))}(…)`."
    elif pair == {VECTOR, _NUMBER}:
        told = "Add or subtract a vector, or change one component: `.x`, `.y`, `.z`."
    elif pair <= _MATH and sign not in PRODUCTS:
        told = f"Make one of the other: `{left}(…)`."
    return told


def _with_nothing(script: Script) -> Iterator[Finding]:
    """What is computed with None, which a method gives that changes its value in place."""
    for node in script.all(ast.BinOp):
        for side in (node.left, node.right):
            if (function := nothing_from(script, side)) and not is_tried(script, node):
                yield Finding(
                    RULE.id, "error", script.span(side),
                    f"`{function}` returns nothing to compute with.{other_way(script, function)}", function,
                )  # fmt: skip


def _sums(script: Script) -> Iterator[Finding]:
    """``sum`` of vectors, which begins with the number 0 unless it is told otherwise."""
    for call in script.all(ast.Call):
        match call:
            case ast.Call(args=[added], keywords=[]) if builtin_called(script, call) == "sum":
                cls = _summed(script, added)
            case _:
                continue
        if cls and not is_tried(script, call):
            start = f"{last_name(cls)}()"
            yield Finding(
                RULE.id, "error", script.span(call),
                f"`sum` begins with the number 0, to which no `{cls}` is added: give it a start, "
                f"`sum(…, {start})`.", cls,
            )  # fmt: skip


def _summed(script: Script, added: ast.expr) -> str:
    """The class of mathutils of everything that a value holds; empty for anything else."""
    match script.type_of(added):
        case Sequence(element=Instance(cls=cls, sure=True)) if cls in _ADDED:
            return cls
        case Tuple(items=items) if items:
            classes = {item.cls if isinstance(item, Instance) and item.sure else "" for item in items}
            return next((cls for cls in classes if len(classes) == 1 and cls in _ADDED), "")
        case _:
            return ""


def _by_item(script: Script) -> Iterator[Finding]:
    """Products of two transformations that ``*`` makes item by item."""
    for node in script.all(ast.BinOp, ast.AugAssign):
        if not isinstance(node.op, ast.Mult):
            continue
        sides = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.target, node.value)
        kinds = [kind for side in sides if isinstance(kind := script.type_of(side), Instance) and kind.sure]
        classes = [kind.cls for kind in kinds]
        if len(classes) < len(sides) or classes[0] != classes[1] or classes[0] not in _TRANSFORMS:
            continue
        sign = "@" if isinstance(node, ast.BinOp) else "@="
        yield Finding(
            RULE.id, "warning", script.span(node),
            f"`*` multiplies two of `{classes[0]}` item by item, since 2.80: `{sign}` makes one transformation of "
            "both.",
            classes[0], (), _fix(script, node, sure=False) if isinstance(node, ast.BinOp) else None,
        )  # fmt: skip


def _fix(script: Script, node: ast.BinOp, *, sure: bool = True) -> Fix | None:
    """The edit that writes the other operator."""
    before, after = script.span(node.left), script.span(node.right)
    where = Span(before.end_line, before.end_column, after.line, after.column)
    text = script.text(where)
    if text.count("*") != 1 or "#" in text:
        return None
    return Fix("Write @", (Edit(where, text.replace("*", "@")),), sure=sure)


RULE = Rule("refused-product", "error", "A product or a sum that mathutils refuses", _check)
