"""Tells which calls in a script do not fit the function that they call: those are no examples."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.symbols import Symbols
    from kb_build.symbols.records import Symbol


def unfit_statements(analysis: Analysis, symbols: Symbols) -> set[ast.stmt]:
    """The statements that call a function without an argument that it requires."""
    found: set[ast.stmt] = set()
    for node, resolution in analysis.resolutions.items():
        if not isinstance(node, ast.Call) or resolution.statement is None or len(resolution.symbols) != 1:
            continue
        symbol = symbols.symbol(resolution.symbols[0])
        if symbol is not None and _lacks_an_argument(node, symbol):
            found.add(resolution.statement)
    return found


def _lacks_an_argument(call: ast.Call, symbol: Symbol) -> bool:
    """Whether a call leaves out what a function of RNA requires; False where ``*`` or ``**`` may hold it."""
    is_of_rna = symbol.kind == "function" and symbol.path.startswith(TYPES)
    is_open = any(isinstance(each, ast.Starred) for each in call.args) or any(
        keyword.arg is None for keyword in call.keywords
    )
    if not is_of_rna or is_open:
        return False
    given = {keyword.arg for keyword in call.keywords}
    taken = symbol.positional
    return any(one.required and one.name not in given for one in taken[len(call.args) :])
