"""Where a script is ready for an error."""

from __future__ import annotations

import ast
import builtins
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Builtin, Tuple, catches, members
from kb_check.calls.resolved import callee_path
from kb_check.running.context_managers import passes_errors
from kb_check.running.line_ranges import LineRanges
from kb_check.script import once_for_each

if TYPE_CHECKING:
    from kb_check.script import Script


def is_tried(script: Script, node: ast.expr | ast.stmt, errors: tuple[str, ...] = ()) -> bool:
    """Whether an error here may be caught: in a ``try``, or by a context manager that may keep it.

    ``errors`` are the names of the classes that it may be of; of any where none is named.
    """
    return node.lineno in _tried_lines(script, errors)


@once_for_each
def _tried_lines(script: Script, errors: tuple[str, ...]) -> LineRanges:
    found: list[tuple[int, int]] = []
    for node in script.all(ast.Try, ast.TryStar, ast.With, ast.AsyncWith):
        match node:
            case ast.Try() | ast.TryStar() if any(_may_catch(script, one, errors) for one in node.handlers):
                found.append((node.lineno, node.body[-1].end_lineno or 0))
            case ast.With() | ast.AsyncWith() if not (passes_errors(node) or _all_blenders(script, node)):
                found.append((node.lineno, node.end_lineno or 0))
            case _:
                pass
    return LineRanges(found)


def _may_catch(script: Script, handler: ast.ExceptHandler, errors: tuple[str, ...]) -> bool:
    """Whether a handler may catch one of some errors, or any where none is named, and not raise it or another."""
    if not errors:
        return True
    if isinstance(handler.body[-1], ast.Raise):
        return False
    kinds = members((script.type_of(handler.type) if handler.type else None) or UNKNOWN)
    kinds = [part for kind in kinds for part in (kind.items if isinstance(kind, Tuple) else (kind,))]
    caught = [
        kind.name
        for kind in kinds
        if isinstance(kind, Builtin) and isinstance(getattr(builtins, kind.name, None), type)
    ]
    return len(caught) < len(kinds) or catches(caught, errors)


def _all_blenders(script: Script, node: ast.With | ast.AsyncWith) -> bool:
    return all(
        isinstance(item.context_expr, ast.Call) and bool(callee_path(script, item.context_expr))
        for item in node.items
    )
