"""The lists of statements in a statement."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


def bodies_of(node: ast.AST) -> Iterator[list[ast.stmt]]:
    """Every list of statements in one: its body, ``else``, handlers, ``finally`` and cases."""
    for name in ("body", "orelse", "finalbody"):
        if isinstance(body := getattr(node, name, None), list):
            yield body
    match node:
        case ast.Try(handlers=parts) | ast.TryStar(handlers=parts) | ast.Match(cases=parts):
            yield from (part.body for part in parts)
        case _:
            pass
