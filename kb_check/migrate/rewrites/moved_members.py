"""Members that are reached in another way, and mean the same there: ``scene.cursor.location``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

# Former member → how it is written now, from its owner on; ``..`` first: from the owner's owner on.
_MOVED = {
    "bpy.types.Scene.cursor_location": "cursor.location",
    "bpy.types.Camera.dof_distance": "dof.focus_distance",
    "bpy.types.Camera.dof_object": "dof.focus_object",
    "bpy.types.CyclesRenderSettings.film_transparent": "..render.film_transparent",
    "bpy.types.RenderSettings.layers": "..view_layers",
    "bpy.types.ShaderNodeMapping.rotation": 'inputs["Rotation"].default_value',
    "bpy.types.ShaderNodeMapping.scale": 'inputs["Scale"].default_value',
    "bpy.types.ShaderNodeMapping.translation": 'inputs["Location"].default_value',
}
# The same where the values are others, too: those that are written out are known, former → now.
_COLOR_SPACE = ("image.colorspace_settings.name", {"NONE": '"Non-Color"', "COLOR": '"sRGB"'})
_REVALUED = {
    "bpy.types.ShaderNodeTexImage.color_space": _COLOR_SPACE,
    "bpy.types.ShaderNodeTexEnvironment.color_space": _COLOR_SPACE,
    "bpy.types.Object.dupli_type": ("instance_type", {"GROUP": '"COLLECTION"'}),
    "bpy.types.RenderSettings.alpha_mode": ("film_transparent", {"TRANSPARENT": "True", "SKY": "False"}),
}
_SHAPE_SCALE = "bpy.types.PoseBone.custom_shape_scale"
# What a member of Cycles' visibility became one of the object itself.
_VISIBILITY = "bpy.types.Object.cycles_visibility"
_VISIBLE = {
    "camera": "visible_camera", "diffuse": "visible_diffuse", "glossy": "visible_glossy",
    "transmission": "visible_transmission", "scatter": "visible_volume_scatter", "shadow": "visible_shadow",
}  # fmt: skip


def _propose(place: Place) -> Iterator[Change]:
    for find in (_moved, _revalued, _scaled, _visible):
        yield from find(place)


def _moved(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_MOVED):
        node, path = row.node, _MOVED[symbol]
        if not isinstance(node, ast.Attribute):
            continue
        owner: ast.expr = node.value
        if path.startswith(".."):
            if not isinstance(owner, ast.Attribute):
                continue
            owner, path = owner.value, path[2:]
        yield place.change(REWRITE.id, symbol, [place.write(node, f"{place.operand(owner)}.{path}")])


def _revalued(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_REVALUED):
        path, values = _REVALUED[symbol]
        node, value = row.node, place.stored_value(row.node)
        text = (
            values.get(value.value)
            if isinstance(value, ast.Constant) and isinstance(value.value, str)
            else None
        )
        if isinstance(node, ast.Attribute) and value is not None and text and _has_owner(place, node, path):
            edits = [place.write(node, f"{place.operand(node.value)}.{path}"), place.write(value, text)]
            yield place.change(REWRITE.id, symbol, edits)


def _scaled(place: Place) -> Iterator[Change]:
    """One number for all axes became one for each."""
    for row, symbol in place.gone(_SHAPE_SCALE):
        node, value = row.node, place.stored_value(row.node)
        is_number = isinstance(value, ast.Constant) and isinstance(value.value, (int, float))
        if isinstance(node, ast.Attribute) and value is not None and is_number:
            three = ", ".join([place.text(value)] * 3)
            edits = [place.write(node, f"{place.text(node)}_xyz"), place.write(value, f"({three})")]
            yield place.change(REWRITE.id, symbol, edits)


def _visible(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_VISIBILITY):
        whole = place.parent(row.node)
        name = _VISIBLE.get(whole.attr, "") if isinstance(whole, ast.Attribute) else ""
        if name and isinstance(row.node, ast.Attribute) and whole is not None:
            text = f"{place.operand(row.node.value)}.{name}"
            yield place.change(REWRITE.id, symbol, [place.write(whole, text)])


def _has_owner(place: Place, node: ast.Attribute, path: str) -> bool:
    """Whether what a member is reached by now is there by then: an image that was assigned before."""
    first, dot, _ = path.partition(".")
    owner = f"{place.text(node.value)}.{first}"
    return not dot or any(
        place.text(other) == owner and other.lineno < node.lineno and isinstance(other.ctx, ast.Store)
        for other in attributes(place.script).get(first, ())
    )


REWRITE = Rewrite("moved-member", _propose)
