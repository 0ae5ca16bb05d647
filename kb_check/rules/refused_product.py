"""A product, a sum or a quotient of mathutils' values that it refuses, or that is hardly the one meant.

Matrices, quaternions and vectors are multiplied with ``@``; ``*`` goes item by item, and only between two of a kind.
Until 2.79 both were ``*``. A colour is multiplied by a number only, an Euler not at all: ``euler.to_matrix()`` is.

```python
ob.matrix_world * vertex.co  # reported
ob.matrix_world @ vertex.co
ob.location + (0, 0, 1)  # reported
ob.location + Vector((0, 0, 1))
```

So is what is computed with None: `matrix.invert() @ vector`, for `matrix.inverted()`.

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

from kb_build.flow.facts import PRODUCTS
from kb_build.flow.types import Instance
from kb_check.calls import nothing_from, other_way
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.rule import Rule
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_MATH = frozenset(f"mathutils.{name}" for name in ("Color", "Euler", "Matrix", "Quaternion", "Vector"))
_SEQUENCE = "a sequence"  # of Python's
_TRANSFORMS = frozenset({"mathutils.Matrix", "mathutils.Quaternion"})


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("product"):
        left, right = row.missing[0], row.missing[-1]
        is_other = (left, right) in PRODUCTS["@"]
        advice = "Multiply them with `@`." if is_other else "Convert one of them first."
        if _SEQUENCE in (left, right):
            advice = "Make a vector of the sequence: `mathutils.Vector(…)`."
        if isinstance(row.node, ast.AugAssign):
            advice = "In place the result must be of the same class."
            advice += " Write `a = b @ a`." if is_other else ""
        fix = _fix(script, row.node) if is_other and isinstance(row.node, ast.BinOp) else None
        yield Finding(
            RULE.id, "error", script.span(row.node), f"`{left} {row.value} {right}` is refused. {advice}",
            left if left in _MATH else right, (), fix,
        )  # fmt: skip
    for row in script.missing("sum"):
        left, right = row.missing[0], row.missing[-1]
        advice = "Convert one of them first."
        if row.value == "/":
            advice = "Vectors and colors are divided by a number, nothing else is divided."
        elif _MATH.issuperset({left, right} - {_SEQUENCE}):
            advice = f"Make one of the other: `{next(cls for cls in (left, right) if cls in _MATH)}(…)`."
        yield Finding(
            RULE.id, "error", script.span(row.node), f"`{left} {row.value} {right}` is refused. {advice}",
            left if left in _MATH else right,
        )  # fmt: skip
    yield from _by_item(script)
    yield from _with_nothing(script)


def _with_nothing(script: Script) -> Iterator[Finding]:
    """What is computed with None, which a method gives that changes its value in place."""
    for node in script.all(ast.BinOp):
        for side in (node.left, node.right):
            if (function := nothing_from(script, side)) and not is_tried(script, node):
                yield Finding(
                    RULE.id, "error", script.span(side),
                    f"`{function}` returns nothing to compute with.{other_way(script, function)}", function,
                )  # fmt: skip


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
