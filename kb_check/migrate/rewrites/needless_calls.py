"""Calls that are not needed any more, since Blender keeps up to date what they calculated."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_NEEDLESS = frozenset(
    (
        "bpy.types.Mesh.calc_normals",
        "bpy.types.Mesh.calc_normals_split",
        "bpy.types.Mesh.create_normals_split",
        "bpy.types.Mesh.free_normals_split",
    )
)


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_NEEDLESS):
        call = place.parent(row.node)
        if isinstance(call, ast.Call) and not call.args and (statement := place.thrown_away(call)):
            yield place.change(REWRITE.id, symbol, [place.delete(statement)])


REWRITE = Rewrite("needless-call", _propose)
