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
_ENSURE_CURVE = "bpy.types.Action.fcurve_ensure_for_datablock"
_ENSURE = "bpy_extras.anim_utils.action_ensure_channelbag_for_slot"


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_CURVES, _GROUPS):
        node = row.node
        if not isinstance(node, ast.Attribute):
            continue
        if symbol == _CURVES and (made := _made(place, node)) is not None:
            call, owner = made
            given = ", ".join([owner, *_given(place, call)])
            text = f"{place.operand(node.value)}.fcurve_ensure_for_datablock({given})"
            yield place.change(REWRITE.id, symbol, [place.write(call, text)], targets=[_ENSURE_CURVE])
        elif (slot := _slot(place, node.value)) is not None:
            action = place.text(node.value)
            text = f"anim_utils.action_ensure_channelbag_for_slot({action}, {slot}).{node.attr}"
            yield place.change(
                REWRITE.id, symbol, [place.write(node, text)], targets=[_ENSURE],
                additions=place.add_import("from bpy_extras import anim_utils"),
            )  # fmt: skip


def _made(place: Place, node: ast.Attribute) -> tuple[ast.Call, str] | None:
    """The call ``action.fcurves.new(…)``, and what the action animates, where that is known.

    An action that is new has no slot yet: what makes the curve makes it, too.
    """
    callee = place.parent(node)
    call = place.parent(callee) if callee is not None else None
    if (
        not isinstance(callee, ast.Attribute)
        or callee.attr != "new"
        or not isinstance(call, ast.Call)
        or call.func is not callee
        or any(isinstance(argument, ast.Starred) for argument in call.args)
    ):
        return None
    action = node.value
    if isinstance(action, ast.Name) and _is_in_use(place, action.id):
        values = [place.stored_value(one) for one in place.stores(action.id)]
        action = values[0] if len(values) == 1 and values[0] is not None else action
    data = action.value if isinstance(action, ast.Attribute) and action.attr == "action" else None
    if isinstance(data, ast.Attribute) and data.attr == "animation_data" and place.is_a(data, _DATA):
        owner = data.value
        is_same = action is node.value or (isinstance(owner, ast.Name) and len(place.stores(owner.id)) == 1)
        return (call, place.argument(owner)) if is_same else None
    return None


def _given(place: Place, call: ast.Call) -> list[str]:
    """What the call is given, by the names that it has now."""
    names = {"action_group": "group_name"}
    keywords = [(names.get(one.arg, one.arg), one.value) for one in call.keywords if one.arg]
    return [
        *map(place.argument, call.args),
        *(f"{name}={place.argument(value)}" for name, value in keywords),
    ]


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
