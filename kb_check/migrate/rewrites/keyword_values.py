"""Keywords whose value is written in another way: ``radius=1`` of a cube is ``size=2``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_DROPPED = r"bpy\.ops\.[\w.]+_add\(layers\)"
_ALIGN = r"bpy\.ops\.[\w.]+_add\(view_align\)"
_AXIS = r"bpy\.ops\.\w+\.\w+\(axis_(forward|up)\)"
_AXES = {f"{sign}{axis}": f"{word}{axis}" for sign, word in (("", ""), ("-", "NEGATIVE_")) for axis in "XYZ"}
_PROPORTIONAL = r"bpy\.ops\.transform\.\w+\(proportional\)"
_DOUBLED = {
    "bpy.ops.mesh.primitive_cube_add(radius)": "size",
    "bpy.ops.mesh.primitive_grid_add(radius)": "size",
    "bpy.ops.mesh.primitive_monkey_add(radius)": "size",
    "bpy.ops.mesh.primitive_plane_add(radius)": "size",
}
# Keyword → the keyword and the value that stand for True; without it, for False.
_CHOSEN = {
    "bpy.ops.mesh.bevel(vertex_only)": ("affect", "VERTICES", "EDGES"),
    "bpy.ops.mesh.bevel(use_custom_profile)": ("profile_type", "CUSTOM", "SUPERELLIPSE"),
}


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_DOUBLED):
        if isinstance(row.node, ast.keyword):
            text = f"{_DOUBLED[symbol]}={_twice(place, row.node.value)}"
            yield place.change(REWRITE.id, symbol, [place.write(row.node, text)])
    for row, match in place.gone_like(_ALIGN):
        if isinstance(row.node, ast.keyword):
            text = f"align={_either(place, row.node.value, 'VIEW', 'WORLD')}"
            yield place.change(REWRITE.id, match[0], [place.write(row.node, text)])
    for row, match in place.gone_like(_PROPORTIONAL):
        if isinstance(row.node, ast.keyword) and isinstance(row.node.value, ast.Constant):
            text = f"use_proportional_edit={row.node.value.value != 'DISABLED'}"
            yield place.change(REWRITE.id, match[0], [place.write(row.node, text)])
    for row, symbol in place.gone(*_CHOSEN):
        if isinstance(row.node, ast.keyword):
            name, yes, no = _CHOSEN[symbol]
            text = f"{name}={_either(place, row.node.value, yes, no)}"
            yield place.change(REWRITE.id, symbol, [place.write(row.node, text)])
    for row, match in place.gone_like(_DROPPED):
        call = place.parent(row.node)
        if isinstance(row.node, ast.keyword) and isinstance(call, ast.Call):
            edit = place.without_keyword(call, row.node)
            if edit is not None:
                yield place.change(REWRITE.id, match[0], [edit])
    yield from _axes(place)


def _axes(place: Place) -> Iterator[Change]:
    for row, match in place.gone_like(_AXIS):
        value = row.node.value if isinstance(row.node, ast.keyword) else None
        name = f"{match[1]}_axis"
        targets = [one.target for one in place.script.names.reader.successors(match[0])]
        if isinstance(value, ast.Constant) and value.value in _AXES and any(name in one for one in targets):
            text = f'{name}="{_AXES[value.value]}"'
            yield place.change(REWRITE.id, match[0], [place.write(row.node, text)])


def _twice(place: Place, value: ast.expr) -> str:
    if isinstance(value, ast.Constant) and isinstance(value.value, (int, float)):
        return repr(value.value * 2)
    return f"2 * {place.operand(value)}"


def _either(place: Place, value: ast.expr, yes: str, no: str) -> str:
    """What a switch chose, as a value of an enumeration."""
    if isinstance(value, ast.Constant):
        return f'"{yes if value.value else no}"'
    return f'"{yes}" if {place.operand(value)} else "{no}"'


REWRITE = Rewrite("keyword-value", _propose)
