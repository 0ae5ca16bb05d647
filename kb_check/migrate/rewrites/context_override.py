"""A dictionary of context members became ``with bpy.context.temp_override(…)``."""

from __future__ import annotations

import ast
import keyword
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Mapping
from kb_build.symbols.api_names import OPERATORS
from kb_check.findings import Span
from kb_check.migrate.change import Change
from kb_check.migrate.place import in_order
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.place import Place

_SINCE = (4, 0)
_WITH = "bpy.types.Context.temp_override"
_SOURCE = "release notes 4.0: Python API"
_REASON = "Operators take no dictionary of context members any more: override the context around the call."


def _propose(place: Place) -> Iterator[Change]:
    if place.target < _SINCE or not place.bpy:
        return
    for row in place.script.resolutions("call"):
        call = row.node
        if not isinstance(call, ast.Call) or not call.args or not row.symbols or row.guarded:
            continue
        statement = place.parent(call)
        if (
            not all(symbol.startswith(OPERATORS) for symbol in row.symbols)
            or not isinstance(statement, (ast.Expr, ast.Assign))
            or not place.has_line(statement)
            or (members := _members(place, call.args[0])) is None
        ):
            continue
        margin = place.margin(statement)
        inner = _without_first(place, call)
        if inner is None:
            continue
        head = place.text(statement)[: -len(place.text(call))]
        body = f"{head}{inner}".replace("\n", "\n    ")
        text = f"with {place.bpy}.context.temp_override({members}):\n{margin}    {body}"
        yield Change(REWRITE.id, (place.write(statement, text),), _REASON, _SOURCE, _SINCE, (_WITH,))


def _members(place: Place, value: ast.expr) -> str | None:
    """A dictionary as keyword arguments; None for what is none."""
    if isinstance(value, ast.Dict):
        names = [key.value for key in value.keys if isinstance(key, ast.Constant)]
        plain = len(names) == len(value.keys) and all(isinstance(n, str) and n.isidentifier() for n in names)
        if plain and not any(keyword.iskeyword(str(name)) for name in names):
            pairs = zip(names, value.values, strict=True)
            return ", ".join(f"{name}={place.argument(item)}" for name, item in pairs)
        return f"**{place.text(value)}"
    kind = place.script.type_of(value)
    if isinstance(kind, Mapping):
        return f"**{place.operand(value)}"
    return None


def _without_first(place: Place, call: ast.Call) -> str | None:
    """The call without its first argument."""
    rest = in_order([*call.args[1:], *call.keywords])
    function = place.text(call.func)
    if not rest:
        return f"{function}()"
    skipped, text = place.between(call.args[0], rest[0])
    if text.strip() != ",":
        return None
    end = place.script.span(call)
    tail = place.script.text(Span(skipped.end_line, skipped.end_column, end.end_line, end.end_column))
    return f"{function}({tail}"


REWRITE = Rewrite("context-override", _propose)
