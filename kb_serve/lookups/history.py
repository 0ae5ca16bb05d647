"""Looks up what other versions of Blender have."""

from __future__ import annotations

import json
from functools import cached_property
from typing import TYPE_CHECKING

from kb_serve.lookups.records import Successor
from simworlds.releases import version_key

if TYPE_CHECKING:
    from kb_serve.lookups.base_file import BaseFile


class HistoryLookups:
    """The symbols of other versions that one base knows, and since when it has its own."""

    def __init__(self, file: BaseFile) -> None:
        self._file = file

    @cached_property
    def history_versions(self) -> list[str]:
        """All minor versions that the history knows, oldest first."""
        return json.loads(self._file.meta.get("history_versions", "[]"))

    @cached_property
    def unknown_modules(self) -> frozenset[str]:
        """The modules of other Blenders that the build lacks which this base was made from."""
        return frozenset(json.loads(self._file.meta.get("unknown_modules", "[]")))

    def removed(self, path: str) -> tuple[str, str, str] | None:
        """(first, last, gone) of a symbol that this version lacks: the versions that have it, the first without it.

        ``gone`` is empty for what only newer versions have.
        """
        rows = self._file.rows("SELECT first, last, gone FROM removed WHERE path = ?", path)
        return rows[0] if rows else None

    def removed_named(self, name: str) -> list[str]:
        """Paths of the symbols of other versions whose last part is exactly ``name``."""
        return [
            row[0] for row in self._file.rows("SELECT path FROM removed WHERE name = ? ORDER BY path", name)
        ]

    def removed_by_key(self, key: str) -> list[str]:
        """Paths of symbols of other versions that are spelled like ``key``."""
        return [
            row[0]
            for row in self._file.rows("SELECT path FROM removed_names WHERE key = ? ORDER BY path", key)
        ]

    def still_works(self, path: str) -> str:
        """The symbol that one gets by a former name that this Blender still takes; "" where it does not."""
        rows = self._file.rows("SELECT taken_as FROM still_works WHERE path = ?", path)
        return rows[0][0] if rows else ""

    def successors(self, path: str) -> list[Successor]:
        """What takes the place of a symbol that this version lacks, best first; empty where no source says it."""
        sql = "SELECT target, how, version, source FROM successors WHERE path = ? ORDER BY position"
        return [Successor(*row) for row in self._file.rows(sql, path)]

    def replaced_by(self, path: str) -> list[str]:
        """Paths of the symbols that other versions had in place of one that this version has."""
        return [
            row[0]
            for row in self._file.rows("SELECT path FROM successors WHERE target = ? ORDER BY path", path)
        ]

    def successors_of_classes(self) -> list[tuple[str, str]]:
        """(removed class, class in its place), the best first for each."""
        sql = """SELECT path, target FROM successors WHERE path GLOB 'bpy.types.*' AND path NOT GLOB 'bpy.types.*[.(:]*'
            AND target != '' ORDER BY path, position"""
        return self._file.rows(sql)

    def similar_names(self, path: str) -> list[tuple[str, float]]:
        """The symbols that resemble one without known successor, with scores, best first."""
        return self._file.rows(
            "SELECT target, score FROM similar_names WHERE path = ? ORDER BY score DESC", path
        )

    def since(self, path: str) -> str:
        """The version that introduced a symbol; empty where that is not known, and for those older than the history."""
        version, lacked = self.arrival(path)
        return "" if lacked else version

    def arrival(self, path: str) -> tuple[str, str]:
        """(the first version known to have a symbol, the last one known to lack it unless it is the one just before);
        both empty for those older than the history.
        """
        rows: list[tuple[str, str]] = self._file.rows(
            "SELECT version, lacked FROM since WHERE path = ?", path
        )
        return rows[0] if rows else ("", "")

    def moved_socket(self, path: str) -> list[tuple[str, str]]:
        """(older version, name of its socket) of a place of a node, ``….inputs[7]``, where this version has another
        socket; newest first.
        """
        rows: list[tuple[str, str]] = self._file.rows(
            "SELECT version, name FROM moved_sockets WHERE path = ?", path
        )
        return sorted(rows, key=lambda row: version_key(row[0]), reverse=True)

    def gone_in(self, version: str) -> list[str]:
        """Paths of the symbols that a version was the first to lack."""
        return [
            row[0]
            for row in self._file.rows("SELECT path FROM removed WHERE gone = ? ORDER BY path", version)
        ]

    def new_in(self, version: str) -> list[str]:
        """Paths of the symbols that a version was the first to have."""
        sql = "SELECT path FROM since WHERE version = ? AND lacked = '' ORDER BY path"
        return [row[0] for row in self._file.rows(sql, version)]
