"""Operators by the words of their names."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import words
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

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

    def beginning(self, name: str) -> list[str]:
        """The operators whose own names begin with the words of a name: ``ptcache.bake_all`` for ``bake``."""
        said = words(name)
        return [path for path, own in self._own_words.items() if own[: len(said)] == said]

    @cached_property
    def _own_words(self) -> dict[str, list[str]]:
        rows = self._reader.rows("SELECT path FROM symbols WHERE kind = 'operator' ORDER BY path")
        return {path: words(path.rpartition(".")[2]) for (path,) in rows}

    @cached_property
    def _words(self) -> dict[str, set[str]]:
        """Those of the module's name as well."""
        return {path: {*own, *words(path.split(".")[2])} for path, own in self._own_words.items()}
