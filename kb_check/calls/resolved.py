"""Which symbol of the API a part of a script surely is: what it calls, the member that it reads."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Builtin
from kb_build.symbols.api_names import OPERATORS
from kb_check.script import once_per_script

if TYPE_CHECKING:
    import re

    from kb_check.script import Script

_DOTS = 3  # of the path of an operator; that of a module has fewer


def member_path(script: Script, attribute: ast.Attribute) -> str:
    """The path of the one symbol that an attribute surely is; empty for none."""
    row = script.analysis.resolutions.get(attribute)
    if row is None or not row.sure or row.guarded or row.missing or len(row.symbols) != 1:
        return ""
    return row.symbols[0]


def callee_path(script: Script, call: ast.Call) -> str:
    """The path of the one thing of the API that a call surely calls; empty for none."""
    row = script.analysis.resolutions.get(call)
    return row.symbols[0] if row and row.kind == "call" and len(row.symbols) == 1 and row.sure else ""


def builtin_called(script: Script, call: ast.Call) -> str:
    """The name of the one of Python's own functions that a call surely calls by this name; empty for none."""
    match call.func:
        case ast.Name(id=name) as callee if script.type_of(callee) == Builtin(name):
            return name
        case _:
            return ""


@once_per_script
def called_operators(script: Script) -> frozenset[str]:
    """The operators that the script calls."""
    rows = script.resolutions("call", "attribute")
    return frozenset(path for row in rows for path in row.symbols if path.startswith(OPERATORS))


def calls_only(script: Script, operators: re.Pattern[str]) -> bool:
    """Whether the paths of all operators that the script calls match."""
    return all(operators.fullmatch(path) for path in called_operators(script) if path.count(".") == _DOTS)
