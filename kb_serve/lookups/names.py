"""Looks up which symbols have a name, an item or an argument."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from kb_build.schema import FORM_NAME, Mark
from kb_serve.lookups.kept_rows import KeptRows, grouped
from kb_serve.lookups.records import ENTRY_COLUMNS, SymbolEntry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.lookups.base_file import BaseFile


class NameLookups:
    """The names in one base."""

    def __init__(self, file: BaseFile) -> None:
        self._file = file
        # (form, id) of everything spelled like a key (see analysis.key), preferred forms first.
        self.by_key = KeptRows(self._by_key, (), 100)
        # The symbols whose last part is a name. A thousand share one, and resolving asks for the same few again and
        # again.
        self.by_name = lru_cache(maxsize=8)(self._by_name)

    def _by_key(self, keys: Sequence[str]) -> dict[str, tuple[tuple[int, str], ...]]:
        rows = self._file.rows_of("SELECT key, form, id FROM names WHERE key", keys, "key, form, id")
        return grouped((key, (form, identifier)) for key, form, identifier in rows)

    def _by_name(self, name: str) -> tuple[SymbolEntry, ...]:
        """Every symbol whose last part is exactly ``name``."""
        rows = self._file.rows(f"SELECT {ENTRY_COLUMNS} FROM symbols WHERE name = ? ORDER BY id", name)
        return tuple(SymbolEntry._make(row) for row in rows)

    def members_named_after(self, word: str) -> list[SymbolEntry]:
        """The properties and functions whose names are a word, or begin with it: ``rotation_euler``."""
        sql = f"""SELECT {ENTRY_COLUMNS} FROM symbols WHERE name >= ? AND name < ? AND grp != 'ui'
            AND kind IN ('property', 'function') AND (name = ? OR name > ?) ORDER BY id"""
        rows = self._file.rows(sql, word, f"{word}`", word, f"{word}_")
        return [SymbolEntry._make(row) for row in rows]

    def enum_owners(self, key: str) -> list[tuple[str, str, str]]:
        """(owner, identifier, name) for every enumeration that has the item."""
        return self._file.rows("SELECT owner, identifier, name FROM enum_items WHERE key = ?", key)

    @cached_property
    def labelled_classes(self) -> dict[str, list[str]]:
        """Label of several words, in small letters → the paths of RNA's classes that have it."""
        sql = "SELECT path, label FROM symbols WHERE owner = 'bpy.types' AND kind = 'class' AND label LIKE '% %'"
        found: dict[str, list[str]] = {}
        for path, label in self._file.rows(f"{sql} ORDER BY path"):
            found.setdefault(label.lower(), []).append(path)
        return found

    @cached_property
    def data_classes(self) -> list[tuple[str, str]]:
        """(path, name) of every data class."""
        return self._file.rows("SELECT path, name FROM symbols WHERE kind = 'class' AND grp = 'data'")

    @cached_property
    def deprecated_properties(self) -> frozenset[str]:
        """The paths of the properties that Blender calls deprecated: dozens, about which every answer asks."""
        sql = "SELECT path FROM symbols WHERE kind = 'property' AND marks & ?"
        return frozenset(path for (path,) in self._file.rows(sql, int(Mark.DEPRECATED)))

    def functions_named(self, prefix: str) -> list[str]:
        """Paths of the functions of data classes whose names begin with a key."""
        sql = """SELECT DISTINCT path FROM names JOIN symbols ON symbols.path = names.id
            WHERE form = ? AND key >= ? AND key < ? AND kind = 'function' AND owner LIKE 'bpy.types.%'"""
        return (
            [row[0] for row in self._file.rows(sql, FORM_NAME, prefix, prefix + "\uffff")] if prefix else []
        )

    def operators_of(self, module: str) -> list[str]:
        """Paths of the operators in a module of ``bpy.ops``, named by its key."""
        sql = "SELECT path FROM symbols WHERE kind = 'operator' AND owner = ? ORDER BY path"
        return [row[0] for row in self._file.rows(sql, f"bpy.ops.{module}")]

    def operators_taking(self, argument: str) -> list[str]:
        """Paths of the operators with an argument of that name."""
        sql = "SELECT path FROM operator_arguments JOIN symbols ON id = operator WHERE argument = ? ORDER BY path"
        return [row[0] for row in self._file.rows(sql, argument)]

    @cached_property
    def operator_arguments(self) -> frozenset[str]:
        """The names of all operators' arguments."""
        return frozenset(
            row[0] for row in self._file.rows("SELECT DISTINCT argument FROM operator_arguments")
        )

    def is_written(self, name: str) -> bool:
        """Whether a name stands in a call's text, or in what Blender's own scripts write: as an argument, say."""
        sql = """SELECT EXISTS (SELECT 1 FROM symbols WHERE kind IN ('function', 'operator') AND instr(line, ?))
            OR EXISTS (SELECT 1 FROM uses WHERE instr(code, ?))"""
        return bool(self._file.rows(sql, name, name)[0][0])
