"""``use_auto_smooth`` became sharp edges, which are set once from the angle."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_USE = "bpy.types.Mesh.use_auto_smooth"
_ANGLE = "bpy.types.Mesh.auto_smooth_angle"
_DEFAULT = "0.523599"  # radians: the 30 degrees that a mesh had
_REASON = (
    "Smooth shading follows sharp edges. They are set here, from the angle, once: where the mesh changes "
    "afterwards, set them again."
)
_CUSTOM = ("normals_split_custom_set", "normals_split_custom_set_from_vertices")
_NO_REASON = "Custom normals are shown without it, and sharp edges would change them."
_MODIFIERS = re.compile(r"\bmodifier_add\b|\.modifiers\.new\b")


def _propose(place: Place) -> Iterator[Change]:
    if not attributes(place.script).keys().isdisjoint(_CUSTOM):
        yield from _left_out(place)
        return
    if _MODIFIERS.search(place.script.code):
        return  # what they make was smoothed as well, which edges of the mesh alone do not do
    angles = {_owner(place, row.node): row.node for row, _ in place.gone(_ANGLE)}
    for row, symbol in place.gone(_USE):
        node = row.node
        value = place.stored_value(node)
        if not isinstance(node, ast.Attribute) or not isinstance(value, ast.Constant):
            continue
        statement = place.statement(node)
        angle_node = angles.get(_owner(place, node))
        edits = [place.delete(statement)]
        if angle_node is not None:
            angle = place.stored_value(angle_node)
            angle_statement = place.statement(angle_node)
            if angle is None or place.body_of(angle_statement) is not place.body_of(statement):
                continue
            if value.value:
                edits.append(place.write(angle_statement, _set_sharp(place, node, place.argument(angle))))
            else:
                edits.append(place.delete(angle_statement))
        elif value.value:
            edits = [place.write(statement, _set_sharp(place, node, _DEFAULT))]
        yield place.change(REWRITE.id, symbol, edits, reason=_REASON)


def _left_out(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_USE, _ANGLE):
        if place.stored_value(row.node) is not None:
            yield place.change(
                REWRITE.id, symbol, [place.delete(place.statement(row.node))], reason=_NO_REASON
            )


def _owner(place: Place, node: ast.AST) -> str:
    return place.text(node.value) if isinstance(node, ast.Attribute) else ""


def _set_sharp(place: Place, node: ast.Attribute, angle: str) -> str:
    return f"{place.operand(node.value)}.set_sharp_from_angle(angle={angle})"


REWRITE = Rewrite("auto-smooth", _propose)
