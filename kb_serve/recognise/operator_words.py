"""Operators by the words of a name that another module would have."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import words

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

OPERATORS = "bpy.ops."
_FEW = 3


class OperatorWords:
    """The operators of one base, by their words."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def having(self, owner: str, name: str) -> list[str]:
        """The operators of other modules that have all words of an operator's name: ``export_scene.fbx`` for
        ``wm.fbx_export``. None where too many have.
        """
        if not owner.startswith(OPERATORS):
            return []
        said = set(words(name))
        having = {path: own for path, own in self._words.items() if said <= own}
        module = set(words(owner.removeprefix(OPERATORS)))
        found = sorted(having, key=lambda path: (-len(module & having[path]), len(having[path])))
        return found if said and len(found) <= _FEW else []

    @cached_property
    def _words(self) -> dict[str, set[str]]:
        rows = self._reader.rows("SELECT path FROM symbols WHERE kind = 'operator' ORDER BY path")
        return {path: set(words(path.removeprefix(OPERATORS))) for (path,) in rows}
