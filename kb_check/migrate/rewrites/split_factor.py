"""``layout.split(percentage=0.3)`` is ``layout.split(factor=0.3)``: it ran from 0 to 1 before, too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_SPLIT = "bpy.types.UILayout.split"
_REASON = "The percentage is called factor; it ran from 0 to 1 before, too."


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(f"{_SPLIT}(percentage)"):
        if edit := place.script.renamed(row.node, "factor"):
            yield place.change(REWRITE.id, symbol, [edit], reason=_REASON, targets=[f"{_SPLIT}(factor)"])


REWRITE = Rewrite("split-factor", _propose)
