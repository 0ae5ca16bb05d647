"""The active object and ``update()`` belong to a view layer, no longer to the scene."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import CONTEXT
from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_ACTIVE = "bpy.types.SceneObjects.active"
_UPDATE = "bpy.types.Scene.update"


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_ACTIVE, _UPDATE):
        node = row.node
        if not isinstance(node, ast.Attribute):
            continue
        if symbol == _UPDATE:
            text = f"{_view_layer(place, node.value)}.update"
        elif isinstance(node.value, ast.Attribute):
            text = f"{_view_layer(place, node.value.value)}.objects.active"
        else:
            continue
        yield place.change(REWRITE.id, symbol, [place.write(node, text)])


def _view_layer(place: Place, scene: ast.expr) -> str:
    """The view layer of a scene: the context's where the scene is the context's, else the scene's first."""
    if isinstance(scene, ast.Attribute) and scene.attr == "scene" and place.is_a(scene.value, CONTEXT):
        return f"{place.operand(scene.value)}.view_layer"
    if isinstance(scene, ast.Name) and (context := _only_context(place, scene.id)):
        return f"{context}.view_layer"
    return f"{place.operand(scene)}.view_layers[0]"


def _only_context(place: Place, name: str) -> str:
    """``bpy.context`` where that is all that a name's scene is ever taken from; else empty."""
    if any(node.arg == name for node in place.script.all(ast.arg)):
        return ""
    values: set[str] = set()
    for node in place.stores(name):
        value = place.stored_value(node)
        if not isinstance(value, ast.Attribute) or value.attr != "scene":
            return ""
        if not place.is_a(value.value, CONTEXT):
            return ""
        values.add(place.text(value.value))
    # Another context's name may mean nothing where the scene is used.
    return values.pop() if len(values) == 1 and values <= {f"{place.bpy}.context"} else ""


REWRITE = Rewrite("view-layer", _propose)
