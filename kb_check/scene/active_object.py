"""The active object, where a script surely reads it or makes it."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import READ_ACTIVE, made_by
from kb_check.calls.resolved import callee_path

if TYPE_CHECKING:
    from kb_check.script import Script


def reads_active(script: Script, node: ast.expr | None) -> bool:
    """Whether an expression surely is the active object, read from the context."""
    row = script.analysis.resolutions.get(node) if node is not None else None
    return row is not None and bool(row.symbols) and READ_ACTIVE.issuperset(row.symbols)


def making_operator(script: Script, statement: ast.stmt) -> str:
    """The operator that a statement calls, if it makes an object and leaves it the active one; empty for others."""
    match statement:
        case ast.Expr(value=ast.Call() as call) if made_by(path := callee_path(script, call)):
            return path
        case _:
            return ""
