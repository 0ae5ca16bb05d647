"""Conditions on ``bpy.app.version`` in a script: which branches a Blender enters."""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kb_check.migrate.change import Version

_OPERATORS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.GtE: operator.ge, ast.Gt: operator.gt, ast.LtE: operator.le, ast.Lt: operator.lt,
}  # fmt: skip


def reaches(node: ast.AST, parents: Mapping[ast.AST, ast.AST], version: Version) -> bool:
    """Whether a Blender may come to a node; False where a condition on the version keeps it out."""
    around = parents.get(node)
    while around is not None:
        if isinstance(around, (ast.If, ast.IfExp)):
            holds = _holds(around.test, version)
            if isinstance(around, ast.If):
                first, other = node in around.body, node in around.orelse
            else:
                first, other = node is around.body, node is around.orelse
            if (first and holds is False) or (other and holds is True):
                return False
        node, around = around, parents.get(around)
    return True


def _holds(test: ast.expr, version: Version) -> bool | None:
    """Whether a condition holds in a version; None if it is not about versions."""
    if not isinstance(test, ast.Compare) or len(test.ops) != 1 or not isinstance(test.left, ast.Attribute):
        return None
    if not ast.unparse(test.left).endswith("app.version") or not isinstance(test.comparators[0], ast.Tuple):
        return None
    numbers = [item.value for item in test.comparators[0].elts if isinstance(item, ast.Constant)]
    compare = _OPERATORS.get(type(test.ops[0]))
    if compare is None or not all(isinstance(number, int) for number in numbers):
        return None
    return compare((*version, 0), tuple(numbers))
