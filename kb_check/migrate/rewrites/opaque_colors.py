"""Colours that got an alpha: a literal of three values gets the fourth, which is 1."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.findings import Edit
from kb_check.migrate.change import Change
from kb_check.migrate.rewrite import Rewrite
from kb_check.text.brackets import bracketed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.place import Place

_SOURCE = "release notes 2.80: Python API"
_REASON = "The colour has an alpha: Blender takes four values."
_SINCE = (2, 80)


def _propose(place: Place) -> Iterator[Change]:
    for row in place.script.resolutions("store"):
        value = place.stored_value(row.node)
        if (
            isinstance(value, (ast.Tuple, ast.List))
            and len(value.elts) == 3
            and not any(isinstance(item, ast.Starred) for item in value.elts)
            and row.symbols
            and all(_has_alpha(place, path) for path in row.symbols)
        ):
            edit = Edit.behind(bracketed(place.script, value.elts[2], value.elts[1]), ", 1.0")
            yield Change(REWRITE.id, (edit,), _REASON, _SOURCE, _SINCE)


def _has_alpha(place: Place, path: str) -> bool:
    symbol = place.script.api.symbols.symbol(path)
    return symbol is not None and symbol.array == (4,) and symbol.subtype.startswith("COLOR")


REWRITE = Rewrite("opaque-color", _propose)
