"""F-curves are in the channel bag of an action's slot, no longer in the action."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_CURVES = "bpy.types.Action.fcurves"
_GROUPS = "bpy.types.Action.groups"
_ENSURE = "bpy_extras.anim_utils.action_ensure_channelbag_for_slot"


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_CURVES, _GROUPS):
        node = row.node
        if not isinstance(node, ast.Attribute) or (slot := _slot(place, node.value)) is None:
            continue
        action = place.text(node.value)
        text = f"anim_utils.action_ensure_channelbag_for_slot({action}, {slot}).{node.attr}"
        yield place.change(
            REWRITE.id, symbol, [place.write(node, text)], targets=[_ENSURE],
            additions=place.add_import("from bpy_extras import anim_utils"),
        )  # fmt: skip


def _slot(place: Place, action: ast.expr) -> str | None:
    """The slot whose curves ``action.fcurves`` were; None where that is not certain.

    They were those of the first slot, which the owner of the animation uses, too.
    """
    if isinstance(action, ast.Attribute) and action.attr == "action" and place.is_a(action.value, _DATA):
        return f"{place.text(action.value)}.action_slot"
    if isinstance(action, ast.Name) and _is_in_use(place, action.id):
        return f"{action.id}.slots[0]"
    return None


def _is_in_use(place: Place, name: str) -> bool:
    """Whether all that a name holds are actions that an owner of animation uses."""
    if any(node.arg == name for node in place.script.all(ast.arg)):
        return False
    values = [place.stored_value(node) for node in place.stores(name)]
    return bool(values) and all(
        isinstance(value, ast.Attribute) and value.attr == "action" and place.is_a(value.value, _DATA)
        for value in values
    )


_DATA = "bpy.types.AnimData"
REWRITE = Rewrite("action-channels", _propose)
