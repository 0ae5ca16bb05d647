"""Looks up how much symbols count, and where Blender's own scripts use them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.lookups.records import Use

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from kb_serve.lookups.base_file import BaseFile
    from kb_serve.lookups.records import SymbolEntry


class UsageLookups:
    """The uses and weights of one base's symbols."""

    def __init__(self, file: BaseFile) -> None:
        self._file = file

    def uses(self, path: str) -> list[Use]:
        """The clearest uses of a symbol in Blender's own scripts and the guides, best first."""
        sql = "SELECT file, line, code FROM uses WHERE path = ? ORDER BY rank"
        return [Use(*row) for row in self._file.rows(sql, path)]

    def use_counts(self, paths: Collection[str]) -> dict[str, int]:
        """How often Blender's own scripts use each of some symbols; those that they do not use are left out."""
        return dict(self._file.rows_of("SELECT path, uses FROM use_counts WHERE path", paths))

    def weights(self, paths: Collection[str]) -> dict[str, float]:
        """How much symbols count among their like; those that count nothing are left out."""
        return dict(self._file.rows_of("SELECT path, weight FROM weights WHERE path", paths))

    def heaviest(self, entries: Iterable[SymbolEntry], least: float = 0.0) -> list[SymbolEntry]:
        """Entries of at least some weight, by weight; those of equal weight keep their order."""
        found = list(entries)
        weights = self.weights([entry.path for entry in found])
        heavy = [entry for entry in found if weights.get(entry.path, 0.0) >= least]
        return sorted(heavy, key=lambda entry: -weights.get(entry.path, 0.0))

    def member_weights(self, owners: Collection[str]) -> dict[str, list[float]]:
        """The weights of the members of classes, by class."""
        sql = """SELECT owner, weight FROM symbols JOIN weights ON weights.path = symbols.path
            WHERE kind IN ('property', 'function') AND owner"""
        weights: dict[str, list[float]] = {}
        for owner, weight in self._file.rows_of(sql, owners):
            weights.setdefault(owner, []).append(weight)
        return weights
