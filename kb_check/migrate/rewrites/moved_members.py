"""Members that are reached in another way, and mean the same there: ``scene.cursor.location``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

# Former member → how it is written now, from its owner on; ``..`` first: from the owner's owner on.
_MOVED = {
    "bpy.types.Scene.cursor_location": "cursor.location",
    "bpy.types.Camera.dof_distance": "dof.focus_distance",
    "bpy.types.Camera.dof_object": "dof.focus_object",
    "bpy.types.RenderSettings.layers": "..view_layers",
    "bpy.types.ShaderNodeTexImage.color_space": "image.colorspace_settings.name",
    "bpy.types.ShaderNodeTexEnvironment.color_space": "image.colorspace_settings.name",
    "bpy.types.ShaderNodeMapping.rotation": 'inputs["Rotation"].default_value',
    "bpy.types.ShaderNodeMapping.scale": 'inputs["Scale"].default_value',
    "bpy.types.ShaderNodeMapping.translation": 'inputs["Location"].default_value',
}


def _propose(place: Place) -> Iterator[Change]:
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


REWRITE = Rewrite("moved-member", _propose)
