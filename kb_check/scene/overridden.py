"""Calls of operators for which ``temp_override`` gives an object that these do not look at."""

from __future__ import annotations

import ast
from bisect import bisect_left, bisect_right
from typing import TYPE_CHECKING

from kb_check.calls.sites import calls

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

_OF_OBJECTS = frozenset(
    {
        "object",
        "active_object",
        "selected_objects",
        "selected_editable_objects",
        "edit_object",
        "area",
        "region",
    }
)


def overridden(script: Script, paths: Collection[str]) -> Iterator[tuple[CallSite, ast.expr]]:
    """Calls of some operators, each with the active object that it is given, which the script does not make active."""
    meant = [call for call in calls(script) if call.callee.symbol.path in paths]
    if not meant:
        return
    made_active = {
        ast.dump(node.value)
        for node in script.all(ast.Assign)
        if any(isinstance(target, ast.Attribute) and target.attr == "active" for target in node.targets)
    }
    for node in script.all(ast.With):
        given = _object_given(node)
        if given is None or ast.dump(given) in made_active:
            continue
        start = bisect_left(meant, node.lineno, key=_line)
        end = bisect_right(meant, node.end_lineno or node.lineno, key=_line)
        yield from ((call, given) for call in meant[start:end])


def _line(call: CallSite) -> int:
    return call.node.lineno


def _object_given(node: ast.With) -> ast.expr | None:
    """The active object that ``temp_override`` gives, and no other view layer with it."""
    for item in node.items:
        match item.context_expr:
            case ast.Call(func=ast.Attribute(attr="temp_override"), args=[], keywords=keywords):
                given = {keyword.arg: keyword.value for keyword in keywords}
                if given.keys() <= _OF_OBJECTS:
                    return given.get("active_object", given.get("object"))
            case _:
                pass
    return None
