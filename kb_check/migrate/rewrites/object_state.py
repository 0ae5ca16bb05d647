"""``ob.select`` and ``ob.hide`` are asked and set by methods: ``ob.select_set(True)``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_METHODS = {"bpy.types.Object.select": "select", "bpy.types.Object.hide": "hide"}


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_METHODS):
        node, name = row.node, _METHODS[symbol]
        if not isinstance(node, ast.Attribute):
            continue
        owner = place.operand(node.value)
        if isinstance(node.ctx, ast.Load):
            text, target, edited = f"{owner}.{name}_get()", f"{name}_get", node
        elif (value := place.stored_value(node)) is not None:
            text, target = f"{owner}.{name}_set({place.argument(value)})", f"{name}_set"
            edited = place.statement(node)
        else:
            continue
        yield place.change(
            REWRITE.id, symbol, [place.write(edited, text)], targets=[f"bpy.types.Object.{target}"]
        )


REWRITE = Rewrite("object-state", _propose)
