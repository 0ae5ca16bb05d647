"""Operators that went to another module: ``bpy.ops.wm.obj_export``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Edit
    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place


def _propose(place: Place) -> Iterator[Change]:
    reader = place.script.names.reader
    for row, match in place.gone_like(r"bpy\.ops\.\w+(?:\.\w+)?"):
        symbol, node = match[0], row.node
        if row.missing[0] == "bpy.ops" and row.kind != "button":  # the module is gone
            around = place.parent(node)
            if not isinstance(around, ast.Attribute):
                continue
            symbol, node = f"bpy.ops.{row.value}.{around.attr}", around
        successors = reader.history.successors(symbol)
        if (
            not isinstance(node, ast.Attribute)
            or not isinstance(node.value, ast.Attribute)
            or len(successors) != 1
            or successors[0].how
            or not successors[0].target.startswith(OPERATORS)
        ):
            continue
        text = f"{place.text(node.value.value)}.{successors[0].target.removeprefix(OPERATORS)}"
        edits = [place.write(node, text)]
        call = place.parent(node)
        if isinstance(call, ast.Call) and call.func is node:
            edits += _renamed_keywords(place, call, symbol, successors[0].target)
        yield place.change(REWRITE.id, symbol, edits, reason=f"{symbol} is {successors[0].target} now.")


def _renamed_keywords(place: Place, call: ast.Call, old: str, new: str) -> Iterator[Edit]:
    """What the new operator calls the keywords of the old one, where only the name differs."""
    reader = place.script.names.reader
    for keyword in call.keywords:
        rows = reader.history.successors(f"{old}({keyword.arg})")
        if len(rows) == 1 and not rows[0].how and rows[0].target.startswith(f"{new}("):
            name = rows[0].target.removeprefix(f"{new}(").removesuffix(")")
            if name != keyword.arg and (edit := place.script.renamed(keyword, name)):
                yield edit


REWRITE = Rewrite("moved-operator", _propose)
