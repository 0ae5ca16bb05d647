"""Blender's version, compared with what it cannot be compared with.

`bpy.app.version` is a tuple of three numbers, `bpy.app.version_string` a text. Python refuses to tell which of a tuple
and a text is less, and a text is compared letter by letter.

```python
if bpy.app.version >= "4.2":  # reported: (4, 2, 0)
    ...
```
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Plain, Tuple, members
from kb_check.calls.resolved import member_path
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_VERSION, _TEXT = "bpy.app.version", "bpy.app.version_string"
_ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
_NO_TUPLES = frozenset({"str", "float", "int"})
_NUMBERS = re.compile(r"(\d+)\.(\d+)(?:\.(\d+))?")


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Compare):
        sides = [node.left, *node.comparators]
        for one, order, other in zip(sides, node.ops, sides[1:], strict=False):
            for version, against in ((one, other), (other, one)):
                path = member_path(script, version) if isinstance(version, ast.Attribute) else ""
                if isinstance(order, _ORDERS) and path in {_VERSION, _TEXT} and not is_tried(script, node):
                    yield from _compared(script, path, against)


def _compared(script: Script, path: str, against: ast.expr) -> Iterator[Finding]:
    kinds = members(script.type_of(against) or UNKNOWN)
    span = script.span(against)
    if path == _VERSION and all(isinstance(kind, Plain) and kind.kind in _NO_TUPLES for kind in kinds):
        text = _as_tuple(against)
        told = f"`{path}` is a tuple, which has no order with {ast.unparse(against)}: write {text or '(4, 2, 0)'}."
        fix = Fix(f"Write {text}", (Edit(span, text),), sure=True) if text else None
        yield Finding(RULE.id, "error", span, told, path, (), fix)
    elif path == _TEXT and all(isinstance(kind, Tuple) for kind in kinds):
        told = f"`{path}` is a text, which has no order with a tuple: compare `{_VERSION}`."
        yield Finding(RULE.id, "error", span, told, path)


def _as_tuple(node: ast.expr) -> str:
    """The version that a text or a number is written for."""
    value = node.value if isinstance(node, ast.Constant) else None
    found = _NUMBERS.fullmatch(str(value)) if isinstance(value, (str, float)) else None
    return f"({int(found[1])}, {int(found[2])}, {int(found[3] or 0)})" if found else ""


RULE = Rule(
    "version-comparison", "error", "Blender's version, compared with what has no order with it", _check
)
