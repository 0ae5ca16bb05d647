"""A product of two of mathutils' values that it refuses.

Matrices, quaternions and vectors are multiplied with ``@``; ``*`` goes item by item, and only between two of a kind.
Until 2.79 both were ``*``. A colour is multiplied by a number only, an Euler not at all: ``euler.to_matrix()`` is.

```python
ob.matrix_world * vertex.co  # reported
ob.matrix_world @ vertex.co
```

Not reported: ``matrix * matrix`` and the like, which both work, with different results.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.facts import PRODUCTS
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("product"):
        left, right = row.missing[0], row.missing[-1]
        is_other = (left, right) in PRODUCTS["@"]
        advice = "Multiply them with `@`." if is_other else "Convert one of them first."
        if isinstance(row.node, ast.AugAssign):
            advice = f"In place the result must be of the same class.{' Write `a = b @ a`.' * is_other}"
        yield Finding(
            RULE.id, "error", script.span(row.node), f"`{left} {row.value} {right}` is refused. {advice}", left,
            (), _fix(script, row.node) if is_other and isinstance(row.node, ast.BinOp) else None,
        )  # fmt: skip


def _fix(script: Script, node: ast.BinOp) -> Fix | None:
    """The edit that writes the other operator."""
    before, after = script.span(node.left), script.span(node.right)
    where = Span(before.end_line, before.end_column, after.line, after.column)
    text = script.text(where)
    if text.count("*") != 1 or "#" in text:
        return None
    return Fix("Write @", (Edit(where, text.replace("*", "@")),), sure=True)


RULE = Rule("refused-product", "error", "A product that mathutils refuses", _check)
