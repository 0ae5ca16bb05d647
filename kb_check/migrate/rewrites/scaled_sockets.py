"""Sockets whose value means something else under their new name, as Blender changes them when it reads an old file."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_NODE = "bpy.types.ShaderNodeBsdfPrincipled"
_COAT, _SUBSURFACE = f'{_NODE}.inputs["Clearcoat"]', f'{_NODE}.inputs["Subsurface"]'
_COAT_SHARE = 0.25
_COAT_REASON = "The coat is four times as strong: the same look takes a quarter."
_SUBSURFACE_REASON = (
    "How far light goes is the scale; the weight mixes it in, which the former value did not."
)


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_COAT, _SUBSURFACE):
        target = place.parent(row.node)
        value = place.stored_value(target) if target is not None else None
        if not isinstance(row.node, ast.Subscript) or not isinstance(target, ast.Attribute) or value is None:
            continue
        inputs = place.text(row.node.value)
        statement = place.statement(target)
        if symbol == _COAT:
            text = f'{inputs}["Coat Weight"].{target.attr} = {_share(place, value)}'
            yield place.change(REWRITE.id, symbol, [place.write(statement, text)], reason=_COAT_REASON)
        elif isinstance(value, ast.Constant) and place.has_line(statement):
            weight, line = f'{inputs}["Subsurface Weight"].{target.attr} = ', f"\n{place.margin(statement)}"
            text = f'{weight}1.0{line}{inputs}["Subsurface Scale"].{target.attr} = {place.text(value)}'
            edit = place.write(statement, text if value.value else f"{weight}{place.text(value)}")
            yield place.change(REWRITE.id, symbol, [edit], reason=_SUBSURFACE_REASON)


def _share(place: Place, value: ast.expr) -> str:
    if isinstance(value, ast.Constant) and isinstance(value.value, (int, float)):
        return repr(round(value.value * _COAT_SHARE, 9))
    return f"{_COAT_SHARE} * {place.operand(value)}"


REWRITE = Rewrite("scaled-socket", _propose)
