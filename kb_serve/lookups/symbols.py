"""Looks up symbols: their rows and records, their members, and how classes derive from each other."""

from __future__ import annotations

import json
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, TYPES
from kb_build.symbols.object_data import data_class
from kb_build.symbols.records import Symbol, symbol_from_json
from kb_serve.lookups.base_file import BaseFile
from kb_serve.lookups.kept_rows import KeptRows
from kb_serve.lookups.records import ENTRY_COLUMNS, SymbolEntry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

EXTEND = "__extend__"  # the identifier of the socket at which a node gets more


class SymbolLookups(BaseFile):
    """The symbols in one base's file. Frequent look-ups are kept."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        # A symbol's row, or None. It takes nearly a kilobyte, and a class has fifty members.
        self.entry = KeptRows(self._entries, None, 700)
        # The whole record of an identifier, or None. It is looked at several times while it is answered with.
        self.symbol = lru_cache(maxsize=32)(self._symbol)
        # The members of a class or module by name; the classes right below one.
        self.members = lru_cache(maxsize=32)(self._members)
        self.subclasses = lru_cache(maxsize=16)(self._subclasses)

    def _entries(self, paths: Sequence[str]) -> dict[str, SymbolEntry | None]:
        rows = self.rows_of(f"SELECT {ENTRY_COLUMNS} FROM symbols WHERE path", paths)
        return {row[0]: SymbolEntry._make(row) for row in rows}

    def _symbol(self, path: str) -> Symbol | None:
        rows = self.rows("SELECT record FROM symbols WHERE path = ?", path)
        return self.record(symbol_from_json, rows[0][0]) if rows else None

    def _members(self, owner: str) -> dict[str, SymbolEntry]:
        rows = self.rows(f"SELECT {ENTRY_COLUMNS} FROM symbols WHERE owner = ? ORDER BY id", owner)
        return {
            row[3] if row[1] != "socket" else row[0][len(owner) + 1 :]: SymbolEntry._make(row) for row in rows
        }

    def _subclasses(self, path: str) -> tuple[SymbolEntry, ...]:
        rows = self.rows(
            f"SELECT {ENTRY_COLUMNS} FROM symbols WHERE base = ? AND base != '' ORDER BY path", path
        )
        return tuple(SymbolEntry._make(row) for row in rows)

    def descendants(self, path: str) -> Iterator[SymbolEntry]:
        """Every class below a class, nearest first."""
        for child in self.subclasses(path):
            yield child
            yield from self.descendants(child.path)

    def labels_below(self, path: str) -> dict[str, str]:
        """The labels of a class and of every class below it."""
        sql = """WITH RECURSIVE below(path) AS (VALUES (?) UNION SELECT symbols.path FROM symbols
            JOIN below ON base = below.path AND base != '') SELECT path, label FROM symbols WHERE path IN below"""
        return dict(self.rows(sql, path))

    def lineage(self, path: str) -> Iterator[SymbolEntry]:
        """A class and its bases up to bpy_struct."""
        entry = self.entry(path)
        while entry is not None:
            yield entry
            entry = self.entry(entry.base) if entry.base else None

    def descends(self, cls: str, ancestor: str) -> bool:
        """Whether a class is ``ancestor`` or derives from it."""
        return any(entry.path == ancestor for entry in self.lineage(cls))

    def member(self, owners: Iterable[str], name: str) -> SymbolEntry | None:
        """The first that one of the owners has of a name; of a socket ``inputs["Factor"]``."""
        paths = {f"{owner}.{name}": owner for owner in owners}
        self.entry.load(paths)
        entries = ((self.entry(path), owner) for path, owner in paths.items())
        return next((entry for entry, owner in entries if entry and entry.owner == owner), None)

    def member_of(self, cls: str, name: str) -> SymbolEntry | None:
        """A class's own or inherited member."""
        return self.member((ancestor.path for ancestor in self.lineage(cls)), name)

    def member_names(self, owner: str) -> list[str]:
        """The names of what a class's instances have, inherited members included, or of a module's: a collection's are
        its own and those of all collections, as it is no structure.
        """
        owners = [ancestor.path for ancestor in self.lineage(owner)] or [owner]
        if self.is_of_collection(owner):
            owners = [owner, *(ancestor.path for ancestor in self.lineage(COLLECTION))]
        return list(dict.fromkeys(name for path in owners for name in self._own_names(path)))

    def _own_names(self, owner: str) -> list[str]:
        """The names alone: a module has thousands, and what else is known of them takes megabytes."""
        name = "CASE kind WHEN 'socket' THEN substr(path, length(owner) + 2) ELSE name END"
        return [row[0] for row in self.rows(f"SELECT {name} FROM symbols WHERE owner = ? ORDER BY id", owner)]

    def members_called(self, owner: str, stem: str) -> list[str]:
        """The names of a class's own members that are ``stem``, or begin with it and go on behind a ``_``."""
        sql = "SELECT name FROM symbols WHERE owner = ? AND (name = ? OR substr(name, 1, ?) = ?) ORDER BY id"
        return [row[0] for row in self.rows(sql, owner, stem, len(stem) + 1, f"{stem}_")]

    def content_lines(self, module: str) -> list[str]:
        """The lines of what a module has, its own machinery last. Not kept, as ``bpy.types`` has thousands."""
        sql = """SELECT line FROM symbols WHERE owner = ? AND grp != 'ui' ORDER BY substr(name, 1, 1) = '_', id"""
        return [row[0] for row in self.rows(sql, module)]

    def takes_more_sockets(self, node: str, side: str) -> bool:
        """Whether a class of nodes gets sockets on a side by its items or its group's interface."""
        return any(name.startswith(f'{side}["{EXTEND}') for name in self.members(node))

    @cached_property
    def object_data(self) -> dict[str, str]:
        """The class of an object's data by the object's type, for the types that have data."""
        types = self.symbol(f"{TYPES}Object.type")
        kinds = [item.identifier for item in types.enum_items] if types else []
        found = {kind: data_class(kind, lambda name: self.entry(TYPES + name) is not None) for kind in kinds}
        return {kind: TYPES + name for kind, name in found.items() if name}

    @cached_property
    def _types_of_data(self) -> dict[str, str]:
        return {cls: kind for kind, cls in self.object_data.items()}

    def object_type(self, cls: str) -> str:
        """The type of an object whose data is of a class; empty for none."""
        kinds = (self._types_of_data.get(entry.path, "") for entry in self.lineage(cls))
        return next(filter(None, kinds), "")

    def is_object_data(self, cls: str) -> bool:
        """Whether objects have instances of a class as data."""
        return self.object_type(cls) != ""

    def pointing_at(self, cls: str) -> list[SymbolEntry]:
        """The pointer properties whose value is a class, given by its name."""
        sql = f"""SELECT {ENTRY_COLUMNS} FROM symbols
            WHERE target = ? AND target != '' AND kind = 'property' AND type = 'pointer' ORDER BY path"""
        return [SymbolEntry._make(row) for row in self.rows(sql, cls)]

    def pointers(self) -> list[SymbolEntry]:
        """All that point to a class."""
        sql = f"SELECT {ENTRY_COLUMNS} FROM symbols WHERE type = 'pointer' AND target != '' ORDER BY path"
        return [SymbolEntry._make(row) for row in self.rows(sql)]

    def collections_with(self, cls: str) -> list[SymbolEntry]:
        """The properties that are collections of a class, given by its name."""
        sql = f"""SELECT {ENTRY_COLUMNS} FROM symbols
            WHERE target = ? AND target != '' AND kind = 'property' AND type = 'collection' ORDER BY path"""
        return [SymbolEntry._make(row) for row in self.rows(sql, cls)]

    def collections_of(self, cls: str) -> list[str]:
        """Paths of the properties whose collections are of a class of their own, given by its name."""
        sql = "SELECT path FROM symbols WHERE collection = ? AND collection != '' AND kind = 'property' ORDER BY id"
        return [row[0] for row in self.rows(sql, cls)]

    def is_of_collection(self, cls: str) -> bool:
        """Whether a class is that of collections, whose instances are no structures."""
        return cls.startswith(TYPES) and bool(self.collections_of(cls.removeprefix(TYPES)))

    @cached_property
    def addon_names(self) -> dict[str, str]:
        """What add-ons register that Blender brings and that are not on from the start: path → add-on."""
        found: dict[str, list[str]] = json.loads(self.meta.get("addon_names", "{}"))
        return {path: addon for addon, paths in found.items() for path in paths}
