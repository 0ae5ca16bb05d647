"""Where a script is ready for an error."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.line_ranges import LineRanges
from kb_check.made_here import callee_path
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from kb_check.script import Script


def is_tried(script: Script, node: ast.expr) -> bool:
    """Whether an error here may be caught: in a ``try``, or by a context manager that is none of Blender's."""
    return node.lineno in _tried_lines(script)


@once_per_script
def _tried_lines(script: Script) -> LineRanges:
    found: list[tuple[int, int]] = []
    for node in script.all(ast.Try, ast.TryStar, ast.With, ast.AsyncWith):
        match node:
            case ast.Try() | ast.TryStar() if node.handlers:
                found.append((node.lineno, node.body[-1].end_lineno or 0))
            case ast.With() | ast.AsyncWith() if not all(_is_blenders(script, item) for item in node.items):
                found.append((node.lineno, node.end_lineno or 0))
            case _:
                pass
    return LineRanges(found)


def _is_blenders(script: Script, item: ast.withitem) -> bool:
    return isinstance(item.context_expr, ast.Call) and bool(callee_path(script, item.context_expr))
