"""Keywords whose value is written in another way: ``radius=1`` of a cube is ``size=2``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_APPLY = r"bpy\.ops\.object\.modifier_apply\(apply_as\)"
_TURNING = "bpy.ops.transform.rotate(axis)"
_END = r"bpy\.(types\.Strips\w+\.new_effect|ops\.sequencer\.\w+_add)\(frame_end\)"
_INPUTS = frozenset({"input1", "input2", "seq1", "seq2"})
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
    for find in (_doubled, _aligned, _proportional, _chosen, _dropped, _axes, _lengths, _turned):
        yield from find(place)


def _written(place: Place, keyword: ast.AST, symbol: str, text: str) -> Iterator[Change]:
    if isinstance(keyword, ast.keyword):
        yield place.change(REWRITE.id, symbol, [place.write(keyword, text)])


def _doubled(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_DOUBLED):
        if isinstance(row.node, ast.keyword):
            yield from _written(
                place, row.node, symbol, f"{_DOUBLED[symbol]}={_twice(place, row.node.value)}"
            )


def _aligned(place: Place) -> Iterator[Change]:
    for row, match in place.gone_like(_ALIGN):
        if isinstance(row.node, ast.keyword):
            text = f"align={_either(place, row.node.value, 'VIEW', 'WORLD')}"
            yield from _written(place, row.node, match[0], text)


def _proportional(place: Place) -> Iterator[Change]:
    for row, match in place.gone_like(_PROPORTIONAL):
        value = row.node.value if isinstance(row.node, ast.keyword) else None
        if isinstance(value, ast.Constant):
            yield from _written(
                place, row.node, match[0], f"use_proportional_edit={value.value != 'DISABLED'}"
            )


def _chosen(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_CHOSEN):
        if isinstance(row.node, ast.keyword):
            name, yes, no = _CHOSEN[symbol]
            yield from _written(place, row.node, symbol, f"{name}={_either(place, row.node.value, yes, no)}")


def _dropped(place: Place) -> Iterator[Change]:
    """What has no effect any more, and what was the usual thing and is the only one now."""
    for row, match in (*place.gone_like(_DROPPED), *place.gone_like(_APPLY)):
        call, value = place.parent(row.node), row.node.value if isinstance(row.node, ast.keyword) else None
        is_usual = isinstance(value, ast.Constant) and value.value == "DATA"
        if not isinstance(row.node, ast.keyword) or not isinstance(call, ast.Call):
            continue
        if is_usual or "apply_as" not in match[0]:
            edit = place.without_keyword(call, row.node)
            if edit is not None:
                yield place.change(REWRITE.id, match[0], [edit])


def _turned(place: Place) -> Iterator[Change]:
    """``axis=(0, 0, 1)`` is ``orient_axis="Z"``; an axis between them, or one that points back, has no such name."""
    for row, symbol in place.gone(_TURNING):
        axis = row.node.value if isinstance(row.node, ast.keyword) else None
        parts = axis.elts if isinstance(axis, (ast.Tuple, ast.List)) else []
        values = [part.value for part in parts if isinstance(part, ast.Constant)]
        if sorted(map(str, values)) in (["0", "0", "1"], ["0.0", "0.0", "1.0"]):
            name = "XYZ"[[bool(value) for value in values].index(True)]
            yield from _written(place, row.node, symbol, f'orient_axis="{name}"')


def _lengths(place: Place) -> Iterator[Change]:
    """``frame_start=1, frame_end=20`` is ``frame_start=1, length=19``; a strip of other strips has their length."""
    for row, match in place.gone_like(_END):
        call, end = place.parent(row.node), row.node
        if not isinstance(end, ast.keyword) or not isinstance(call, ast.Call):
            continue
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        start = given.get("frame_start") or (
            call.args[3] if "new_effect" in match[0] and len(call.args) > 3 else None
        )
        if _INPUTS.isdisjoint(given) and start is not None:
            text = f"length={_difference(place, end.value, start)}"
            yield place.change(REWRITE.id, match[0], [place.write(end, text)])


def _difference(place: Place, one: ast.expr, other: ast.expr) -> str:
    match one, other:
        case ast.Constant(value=int(end)), ast.Constant(value=int(start)):
            return repr(end - start)
        case _:
            return f"{place.operand(one)} - {place.operand(other)}"


def _axes(place: Place) -> Iterator[Change]:
    for row, match in place.gone_like(_AXIS):
        value = row.node.value if isinstance(row.node, ast.keyword) else None
        name = f"{match[1]}_axis"
        targets = [one.target for one in place.script.names.reader.history.successors(match[0])]
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
