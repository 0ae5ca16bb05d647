"""The collections that a thing has, and the functions that change them: of a collection, or of what has it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import ID, STRUCT, TYPES
from kb_build.symbols.flags import empty_when_new
from kb_serve.recognise.elsewhere.elements import ADDED_BY

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

BMESH = "bmesh.types.BMesh"
BMESH_TYPES = "bmesh.types."
_ANY = "AnyType"


class Held(NamedTuple):
    """A collection, how it is reached from a thing, a function that changes it, and the call of that."""

    collection: SymbolEntry
    access: str
    function: SymbolEntry
    call: str


def held_by(owner: str, reader: BaseReader, *, empty: bool = False) -> Iterator[tuple[SymbolEntry, str]]:
    """The collections of a thing, then those of its own parts, with how they are reached; not what every data-block
    has, nor, unless ``empty``, of a part that new things lack.
    """
    members = members_of(owner, reader)
    yield from _collections(members, "")
    for part in members:
        is_part = part.type == "pointer" and part.is_read_only and bool(part.target) and part.owner != ID
        if is_part and (empty or not is_none_when_new(part, reader)):
            yield from _collections(members_of(f"{TYPES}{part.target}", reader), f"{part.name}.")


def members_of(cls: str, reader: BaseReader) -> list[SymbolEntry]:
    """The members of a class and of its bases, but for what everything has."""
    lineage = [entry.path for entry in reader.lineage(cls) if entry.path != STRUCT]
    return [member for path in lineage for member in reader.members(path).values()]


def is_none_when_new(pointer: SymbolEntry, reader: BaseReader) -> bool:
    """Whether a pointer is None on new things."""
    symbol = reader.symbol(pointer.path)
    return symbol is not None and empty_when_new(symbol) is not None


def _collections(members: Iterable[SymbolEntry], before: str) -> Iterator[tuple[SymbolEntry, str]]:
    """Those of some members that are collections, with how they are reached behind ``before``."""
    for one in members:
        is_collection = (one.type == "collection" and one.target) or one.type.startswith(BMESH_TYPES)
        if (is_collection or one.path in ADDED_BY) and not one.is_deprecated and one.owner != ID:
            yield one, before + one.name


def collections_with(cls: SymbolEntry, reader: BaseReader) -> list[SymbolEntry]:
    """The collections of instances of a class; of a bmesh's elements, those of the bmesh."""
    if not cls.path.startswith(BMESH_TYPES):
        return reader.collections_with(cls.name)
    return [one for one in reader.members(BMESH).values() if one.type.startswith(BMESH_TYPES)]


def class_of(collection: SymbolEntry) -> str:
    """The class with the functions of a collection itself."""
    return f"{TYPES}{collection.collection}" if collection.type == "collection" else collection.type


def function_of(collection: SymbolEntry, name: str, reader: BaseReader) -> SymbolEntry | None:
    """The function of that name which the class of a collection has itself."""
    member = reader.entry(f"{class_of(collection)}.{name}")
    return member if member and member.kind == "function" else None


def of_owner(collection: SymbolEntry, names: Iterable[str], reader: BaseReader) -> SymbolEntry | None:
    """The first of some functions of what has a collection, if it takes an element of that."""
    for name in names:
        function = reader.entry(f"{collection.owner}.{name}")
        element = reader.entry(f"{TYPES}{collection.target}")
        if function and element and takes(function, element, reader):
            return function
    return None


def first_function(collection: SymbolEntry, names: Iterable[str], reader: BaseReader) -> SymbolEntry | None:
    """The first of some functions that a collection has, or else what has it."""
    own = next(filter(None, (function_of(collection, name, reader) for name in names)), None)
    return own or (None if collection.collection else of_owner(collection, names, reader))


def takes(function: SymbolEntry, cls: SymbolEntry, reader: BaseReader) -> bool:
    """Whether the first that a function wants is an instance of a class."""
    symbol = reader.symbol(function.path) if function.kind == "function" else None
    first = symbol.parameters[0].type if symbol and symbol.parameters else ""
    return first in {cls.name, cls.path, _ANY}


def held_with(collection: SymbolEntry, access: str, function: SymbolEntry, reader: BaseReader) -> Held:
    """A collection with a function of it, or of what has it."""
    before = access if function.owner == class_of(collection) else access.rpartition(".")[0]
    return Held(collection, access, function, call_of(function, reader, f"{before}." if before else ""))


def call_of(function: SymbolEntry, reader: BaseReader, before: str = "") -> str:
    """A call of a function with what it wants."""
    symbol = reader.symbol(function.path)
    wanted = [one.name for one in symbol.parameters if one.required] if symbol else []
    return f"{before}{function.name}({', '.join(wanted)})"
