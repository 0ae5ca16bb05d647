"""Arguments of layouts that must be named: ``layout.label(text="…")``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.change import Change
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.place import Place

_SINCE = (2, 80)
_SOURCE = "release notes 2.80: Python API"
_REASON = "Arguments of layouts that can be left out must be given by name."
_LAYOUT = "bpy.types.UILayout."
_SPLIT = f"{_LAYOUT}split(percentage)"
# Method → the names of the arguments that used to be given by place, and how many still may be.
_NAMES = {
    "label": (("text",), 0),
    "row": (("align",), 0),
    "column": (("align",), 0),
    "split": (("factor", "align"), 0),
    "prop": (("data", "property", "text"), 2),
    "operator": (("operator", "text"), 1),
    "menu": (("menu", "text"), 1),
    "separator": (("factor",), 0),
}


def _propose(place: Place) -> Iterator[Change]:
    if place.target < _SINCE:
        return
    for row, symbol in place.gone(_SPLIT):
        if edit := place.script.renamed(row.node, "factor"):
            reason = "The percentage is called factor; it ran from 0 to 1 before."
            yield place.change(REWRITE.id, symbol, [edit], reason=reason, targets=[f"{_LAYOUT}split(factor)"])
    for row in place.script.resolutions("call"):
        call = row.node
        if len(row.symbols) != 1 or not isinstance(call, ast.Call) or not row.sure:
            continue
        names, plain = _NAMES.get(row.symbols[0].removeprefix(_LAYOUT), ((), 0))
        given = call.args[plain:]
        free = names[plain:]
        taken = {keyword.arg for keyword in call.keywords}
        if (
            row.symbols[0].startswith(_LAYOUT)
            and 0 < len(given) <= len(free)
            and not any(isinstance(argument, ast.Starred) for argument in call.args)
            and not taken & {None, *free[: len(given)]}
        ):
            edits = tuple(
                place.write(argument, f"{name}={place.argument(argument)}")
                for name, argument in zip(free, given, strict=False)
            )
            yield Change(REWRITE.id, edits, _REASON, _SOURCE, _SINCE)


REWRITE = Rewrite("layout-argument", _propose)
