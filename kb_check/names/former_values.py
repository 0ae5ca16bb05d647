"""What becomes of the value that a name of former versions is given, where what took its place wants another one.

``glare.quality = 'HIGH'``: the input that stands for it takes 'High'. Whoever writes the new name alone gets the next
error.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.paths import argument_of, plain_path
from kb_check.syntax.literals import written
from kb_serve.recognise.likely.likely_values import value_there

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.flow.values.types import Resolution
    from kb_check.script import Script

_COLOR = 4  # numbers of a colour's socket
_NUMBERS = (ast.Tuple, ast.List)


def new_value(script: Script, row: Resolution, instead: Sequence[str]) -> str:
    """A sentence on the value for the first of what took a name's place; empty where the old one may do."""
    node = _given(row)
    if node is None or not instead:
        return ""
    node = written(script, node)
    kind, values = _taken(script, instead[0])
    if values and isinstance(node, ast.Constant):
        return value_there(node.value, values)
    if kind == "rgba" and isinstance(node, _NUMBERS) and len(node.elts) == _COLOR - 1:
        return f"It takes {_COLOR} numbers, with alpha."
    return ""


def _given(row: Resolution) -> ast.expr | None:
    """What a keyword or an attribute is given."""
    if isinstance(row.node, ast.keyword):
        return row.node.value
    match row.statement:
        case ast.Assign(targets=[target], value=value) if target is row.node:
            return value
        case _:
            return None


def _taken(script: Script, path: str) -> tuple[str, list[str]]:
    """(type, values) of a property, a socket, or an operator's argument."""
    symbol, argument = script.api.symbols.symbol(plain_path(path)), argument_of(path)
    parameters = symbol.parameters if symbol is not None and argument else ()
    named = next((one for one in parameters if one.name == argument), None)
    found = named if argument else symbol
    return (found.type, [item.identifier for item in found.enum_items]) if found is not None else ("", [])
