"""Blender's lists of handlers, in a script."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import HANDLERS
from kb_check.syntax.bindings import alias

if TYPE_CHECKING:
    import ast

    from kb_check.script import Script


def handler_list(script: Script, node: ast.expr) -> str:
    """The path of the list of handlers that an expression surely is; empty if it is none."""
    row = script.analysis.resolutions.get(alias(script, node))
    path = row.symbols[0] if row and row.sure and not row.guarded and len(row.symbols) == 1 else ""
    symbol = script.api.symbols.symbol(path) if path.startswith(HANDLERS) else None
    return path if symbol and symbol.type.startswith("list") else ""
