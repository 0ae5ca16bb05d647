"""Values of enumerations that were only renamed, though the source adds a remark."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

# What was only given another name. (Where ``how`` is empty, a finding's own fix renames it.)
_RENAMED = frozenset(
    (
        "bpy.types.RenderSettings.engine:BLENDER_EEVEE_NEXT",
        "bpy.types.RenderSettings.engine:BLENDER_EEVEE",
        "bpy.types.ColorManagedViewSettings.look:High Contrast",
    )
)


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_RENAMED):
        successors = place.script.names.reader.successors(symbol)
        name = successors[0].target.rpartition(":")[2] if successors else ""
        if name and (edit := place.script.renamed(row.node, name)):
            yield place.change(REWRITE.id, symbol, [edit])


REWRITE = Rewrite("renamed-value", _propose)
