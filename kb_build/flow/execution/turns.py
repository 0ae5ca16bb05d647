"""What a loop's turns have, one by one, where the values that it goes through are written out with texts among them."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.texts import has_passed, has_texts, pairs_of
from kb_build.flow.values.types import INT, Builtin, Mapping, Tuple, Type

if TYPE_CHECKING:
    from collections.abc import Mapping as Rows
    from collections.abc import Sequence as Statements

_MOST_TURNS = 24
_SAME_ITEMS = frozenset({"list", "tuple", "sorted", "reversed", "iter"})
_LEAVING = (ast.Break, ast.Return, ast.Yield, ast.YieldFrom)


def turns(node: ast.expr, types: Rows[ast.expr, Type], body: Statements[ast.stmt]) -> list[Type]:
    """What the turns of a loop over an expression, which was read, surely have; none where there is no text to follow.

    A loop that may be left has its first turn for sure.
    """
    found = _items(node, types) or []
    if not 1 < len(found) <= _MOST_TURNS:
        return []
    followed = [kind for kind in found if not has_passed(kind) and has_texts(kind)]
    if len(followed) < len(found):
        return []
    may_end = any(isinstance(part, _LEAVING) for statement in body for part in walk(statement))
    return followed[:1] if may_end else followed


def _items(  # noqa: PLR0911 - one return a form
    node: ast.expr, types: Rows[ast.expr, Type]
) -> list[Type] | None:
    """What an expression gives one after the other; None where that is not written out."""
    kind = types.get(node)
    if isinstance(kind, Tuple):
        return list(kind.items)
    if isinstance(kind, Mapping):
        return [name for name, _ in pairs_of(kind)]
    called = types.get(node.func) if isinstance(node, ast.Call) else None
    if not isinstance(node, ast.Call) or not isinstance(called, Builtin) or node.keywords:
        return None
    if isinstance(called.receiver, Mapping) and not node.args:
        pairs = pairs_of(called.receiver)
        match called.name:
            case "items":
                return [Tuple(pair) for pair in pairs]
            case "keys":
                return [name for name, _ in pairs]
            case "values":
                return [value for _, value in pairs]
            case _:
                return None
    rows = [_items(argument, types) for argument in node.args]
    if called.receiver is not None or not rows or any(row is None for row in rows):
        return None
    columns = [row for row in rows if row is not None]
    if called.name == "zip":
        return [Tuple(items) for items in zip(*columns, strict=False)]
    if called.name == "enumerate":
        return [Tuple((INT, item)) for item in columns[0]]
    return columns[0] if called.name in _SAME_ITEMS else None
