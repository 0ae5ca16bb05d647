"""What is None where there is nothing to give: members of the context, look-ups by name, pointers of new things."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import BLEND_DATA, CONTEXT, ID, STRUCT, TYPES
from kb_build.symbols.flag_names import WITHOUT_ACTIVE
from kb_build.symbols.flags import empty_when_new, fillers

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

ANY = frozenset(
    {STRUCT, ID, f"{TYPES}PropertyGroup", f"{TYPES}AnyType"}
)  # what leads to these may lead to anything
WEIGHTY = 9.0  # the weight from which on a pointer is one that scripts come upon without having asked for it
_OBJECT_DATA = f"{TYPES}Object.data"
_FEW = 2


class Absent:
    """Finds in one base what may give no thing of a class."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def usual(self, name: str) -> SymbolEntry | None:
        """The member of that name which scripts use most, of those of things that may be absent; None if none is."""
        entries = [
            entry
            for entry in self._reader.names.by_name(name)
            if entry.kind in {"property", "function"}
            and entry.owner.startswith(TYPES)
            and entry.group != "ui"
        ]
        weights = self._reader.usage.weights([entry.path for entry in entries])
        least = max(weights.values(), default=0.0) / 2
        usual = (
            entry for entry in self._reader.usage.heaviest(entries) if weights.get(entry.path, 0.0) >= least
        )
        return next((entry for entry in usual if self.sources(entry.owner)), None)

    def in_context(self, cls: str) -> list[str]:
        """The paths of what in the context leads to such a thing, and is None where no object is active."""
        leading = (one for one in self._of_what_is_active if self._reader.descends(TYPES + one.target, cls))
        return [f"bpy.context.{entry.name}" for entry in leading][:_FEW]

    def looked_up(self, cls: str) -> str:
        """The path of the collection in which scripts mostly look for such things by name; empty where they do not.

        Data-blocks are looked for among all that there are.
        """
        if not self._reader.member_of(cls, "name"):
            return ""
        kinds = [entry.name for entry in self._reader.lineage(cls) if entry.path not in ANY]
        collections = [entry for kind in kinds for entry in self._reader.collections_with(kind)]
        ranked = sorted(self._reader.usage.heaviest(collections), key=lambda entry: entry.owner != BLEND_DATA)
        return ranked[0].path if ranked else ""

    def pointer_to(self, cls: str) -> str:
        """The path of the pointer, None on new things, by which scripts mostly come to such a thing; empty for none."""
        if self._reader.is_object_data(cls):
            return _OBJECT_DATA
        pointers = [one for one in self._reader.pointing_at(cls.removeprefix(TYPES)) if one.owner != cls]
        weights = self._reader.usage.weights([entry.path for entry in pointers])
        ranked = self._reader.usage.heaviest(pointers)
        weighty = (entry.path for entry in ranked if weights.get(entry.path, 0.0) >= WEIGHTY)
        return next((path for path in weighty if is_empty_when_new(path, self._reader)), "")

    def sources(self, cls: str) -> list[str]:
        """The paths of all of these, the likeliest first."""
        return [path for path in (*self.in_context(cls), self.pointer_to(cls), self.looked_up(cls)) if path]

    def note(self, cls: str) -> str:
        """Where a thing of a class may have come from that is None; empty where that is not known."""
        causes: list[str] = []
        if context := self.in_context(cls):
            names = " and ".join(f"`{path}`" for path in context)
            causes.append(f"{names} {'are' if len(context) > 1 else 'is'} None where no object is active")
        if pointer := self.pointer_to(cls):
            causes.append(f"`{pointer}` is None {self._where_empty(pointer)}")
        if looked_up := self.looked_up(cls):
            causes.append(f"`{as_written(looked_up)}.get(name)` is None where nothing has the name")
        return ", ".join(causes)

    def _where_empty(self, pointer: str) -> str:
        symbol = self._reader.symbol(pointer)
        empty = empty_when_new(symbol) if symbol else None
        if symbol and (calls := fillers(symbol)):
            return f"before `{calls[0]}`"
        return f"on a new {empty.made[0]}" if empty and empty.made else "on what is new"

    @cached_property
    def _of_what_is_active(self) -> list[SymbolEntry]:
        """The members of the context, most used first, that are None where no object is active."""
        symbols = {
            entry: self._reader.symbol(entry.path)
            for entry in self._reader.members(CONTEXT).values()
            if entry.kind == "context" and entry.type == "pointer"
        }
        return self._reader.usage.heaviest(
            entry for entry, symbol in symbols.items() if symbol and WITHOUT_ACTIVE in symbol.flags
        )


def as_written(collection: str) -> str:
    """What scripts write for a collection: ``bpy.data.objects``, ``nodes``."""
    owner, _, name = collection.rpartition(".")
    return f"bpy.data.{name}" if owner == BLEND_DATA else name


def is_empty_when_new(path: str, reader: BaseReader) -> bool:
    """Whether a pointer is None on new things."""
    symbol = reader.symbol(path)
    return symbol is not None and empty_when_new(symbol) is not None
