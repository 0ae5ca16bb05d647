"""Objects are linked to collections: ``scene.collection.objects.link(ob)``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_LINK = "bpy.types.SceneObjects.link"
_UNLINK = "bpy.types.SceneObjects.unlink"


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(_LINK, _UNLINK):
        node = row.node
        call = place.parent(node)
        if (
            not isinstance(node, ast.Attribute)
            or not isinstance(node.value, ast.Attribute)
            or not isinstance(call, ast.Call)
            or len(call.args) != 1
            or (statement := place.thrown_away(call)) is None  # what it returned was an object's base
        ):
            continue
        if symbol == _LINK:
            text = f"{place.operand(node.value.value)}.collection.objects.link"
            yield place.change(REWRITE.id, symbol, [place.write(node, text)])
        elif isinstance(call.args[0], ast.Name):
            # An object may be in any of the scene's collections.
            name = place.text(call.args[0])
            loop = f"for collection in tuple({name}.users_collection):"
            text = f"{loop}\n{place.margin(statement)}    collection.objects.unlink({name})"
            if place.has_line(statement):
                yield place.change(REWRITE.id, symbol, [place.write(statement, text)])


REWRITE = Rewrite("scene-objects", _propose)
