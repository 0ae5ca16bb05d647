"""What is done to a thing by what holds it: ``modifier.remove()`` is ``obj.modifiers.remove(modifier)``, and
``collection.append(obj)`` is ``collection.objects.link(obj)``.

Python's lists and other programs teach such methods; in Blender the collections of things have them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import stem, stems_of, words
from kb_build.symbols.api_names import ID, STRUCT, TYPES
from kb_build.symbols.flags import empty_when_new
from kb_build.symbols.paths import last_name
from kb_serve.recognise.names.elements import ADDED_BY, REMOVED_BY, Elsewhere

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_serve.reader import BaseReader, SymbolEntry

_FEW = 3
_ROOT = f"{TYPES}BlendData"
_TAKING_OUT = frozenset({"discard", "pop", "remove", "unlink"})
_REMOVING = _TAKING_OUT | {"clear", "delete", "destroy", "dispose", "erase", "free", "kill", "purge"}
_PUTTING = frozenset({"add", "append", "attach", "insert", "link", "push", "put"})
_MAKING = _PUTTING | {"create", "make", "new"}
_ALL_AT_ONCE = "clear"  # empties a thing, unless it says of what
_REMOVERS, _TAKERS, _MAKERS = ("remove", "unlink"), ("link", "append"), ("insert", "new", "add", "load")
_DOES = {"unlink": "lets go of one", **dict.fromkeys(_TAKERS, "takes one")}


class _Held(NamedTuple):
    """A collection, how it is reached from a thing, and a function of it."""

    collection: SymbolEntry
    access: str
    function: SymbolEntry


def by_what_holds_it(owner: str, name: str, reader: BaseReader) -> list[Elsewhere]:
    """What does to instances of a class, or to what they hold, what a name says that the class lacks; the likeliest
    first, and none for what is no verb for that.
    """
    verb, *what = words(name) or [""]
    entry = reader.entry(owner)
    if entry is None or entry.kind != "class" or entry.group != "data":
        return []
    if what and verb in _REMOVING | _MAKING:
        wanted, table = (_REMOVERS, REMOVED_BY) if verb in _REMOVING else ((*_TAKERS, *_MAKERS), ADDED_BY)
        called = [] if _says_the_same(owner, name, reader) else _called(owner, what, reader)
        return _done(called, wanted, table, reader)[:_FEW]
    if verb in _PUTTING:
        held = list(_held_by(owner, reader))
        taken = _told(_having(held, _TAKERS, reader), reader)
        made = [] if taken else _done(held, _MAKERS, ADDED_BY, reader)
        return taken or (made if len(made) <= _FEW else [])
    if verb in _REMOVING and verb != _ALL_AT_ONCE:
        held = list(_held_by(owner, reader)) if verb in _TAKING_OUT else []
        return [*_told(_having(held, ("unlink",), reader), reader), *_removed(owner, verb, reader)][:_FEW]
    return []


def _says_the_same(owner: str, name: str, reader: BaseReader) -> bool:
    """Whether a class has a member of the same words: ``shape_key_add``, who says ``add_shape_key``."""
    said = stems_of(name)
    return any(stems_of(own) == said for own in reader.member_names(owner))


def _removed(owner: str, verb: str, reader: BaseReader) -> list[Elsewhere]:
    """How instances of a class are removed from what holds them: for good before out of something, but that first which
    is called as the verb.
    """
    found: list[_Held] = []
    others: list[Elsewhere] = []
    for cls in reader.lineage(owner):
        for held in reader.collections_with(cls.name):
            functions = (_function_of(held, name, reader) for name in _REMOVERS)
            found += [
                _Held(held, held.name, one) for one in functions if one and _takes(one, cls.name, reader)
            ]
            others += filter(None, (REMOVED_BY.get(held.path),))
    weights = reader.weights([one.collection.path for one in found])

    def order(one: _Held) -> tuple[bool, bool, float]:
        is_other = verb in _REMOVERS and one.function.name != verb
        return is_other, one.collection.owner != _ROOT, -weights.get(one.collection.path, 0.0)

    removed = [_removal(held, reader) for held in sorted(found, key=order)]
    return removed or list(dict.fromkeys(others))


def _removal(held: _Held, reader: BaseReader) -> Elsewhere:
    """How what holds a thing removes it."""
    path, call = held.function.path, f"{held.access}.{_call(held.function, reader)}"
    does = "lets go of it" if held.function.name == "unlink" else "removes it"
    if held.collection.owner == _ROOT:
        return Elsewhere(path, f"`bpy.data.{call}` {does} (`{path}`).")
    holder = held.collection.owner.removeprefix(TYPES)
    return Elsewhere(path, f"The `{holder}` that holds it {does}: `.{call}` (`{path}`).")


def _done(
    held: Iterable[tuple[SymbolEntry, str]],
    wanted: Sequence[str],
    table: Mapping[str, Elsewhere],
    reader: BaseReader,
) -> list[Elsewhere]:
    """What collections do by the first of some functions, or what does it for them."""
    found: list[Elsewhere] = []
    for collection, access in held:
        if function := _first_function(collection, wanted, reader):
            found += _told([_Held(collection, access, function)], reader)
        elif (other := table.get(collection.path)) and reader.entry(other.path):
            found.append(other)
    return list(dict.fromkeys(found))


def _having(
    held: Iterable[tuple[SymbolEntry, str]], wanted: Sequence[str], reader: BaseReader
) -> list[_Held]:
    """The collections with one of some functions, most used first; none where there are too many to tell."""
    found = [
        _Held(collection, access, function)
        for collection, access in held
        if (function := _first_function(collection, wanted, reader))
    ]
    weights = reader.weights([one.function.path for one in found])
    found.sort(key=lambda one: -weights.get(one.function.path, 0.0))
    return found if len(found) <= _FEW else []


def _told(found: Iterable[_Held], reader: BaseReader) -> list[Elsewhere]:
    told: list[Elsewhere] = []
    for collection, access, function in found:
        call = f"{access}.{_call(function, reader)}"
        does = _DOES.get(function.name, "makes one" if function.name in _MAKERS else "removes one")
        whole = f"bpy.data.{call}" if collection.owner == _ROOT else f".{call}"
        told.append(Elsewhere(function.path, f"Its `.{access}` {does}: `{whole}` (`{function.path}`)."))
    return told


def _called(owner: str, what: Sequence[str], reader: BaseReader) -> list[tuple[SymbolEntry, str]]:
    """Those of the collections of a thing whose name, or whose elements' class, says most nearly what is meant: by its
    last word rather than by another one, and with the fewest words besides.
    """
    said = stems_of(" ".join(what))
    found: dict[tuple[SymbolEntry, str], tuple[bool, int]] = {}
    for collection, access in _held_by(owner, reader, empty=True):
        names = [words(name) for name in (collection.name, collection.target)]
        far = [(stem(name[-1]) not in said, len(name)) for name in names if said <= set(map(stem, name))]
        if far:
            found[collection, access] = min(far)
    return [held for held, far in found.items() if far == min(found.values())][:_FEW]


def _held_by(owner: str, reader: BaseReader, *, empty: bool = False) -> Iterator[tuple[SymbolEntry, str]]:
    """The collections of a thing, then those of its own parts, with how they are reached; not what every data-block
    has, nor, unless ``empty``, of a part that new things lack.
    """
    members = _members(owner, reader)
    yield from _collections(members, "")
    for part in members:
        if (
            part.type == "pointer"
            and part.is_read_only
            and part.target
            and (empty or not _is_none(part, reader))
        ):
            yield from _collections(_members(f"{TYPES}{part.target}", reader), f"{part.name}.")


def _members(cls: str, reader: BaseReader) -> list[SymbolEntry]:
    """The members of a class and of its bases, but for what every data-block has."""
    lineage = [entry.path for entry in reader.lineage(cls) if entry.path not in {ID, STRUCT}]
    return [member for path in lineage for member in reader.members(path).values()]


def _collections(members: Iterable[SymbolEntry], before: str) -> Iterator[tuple[SymbolEntry, str]]:
    for one in members:
        if one.type == "collection" and one.target and not one.is_deprecated:
            yield one, before + one.name


def _is_none(pointer: SymbolEntry, reader: BaseReader) -> bool:
    symbol = reader.symbol(pointer.path)
    return symbol is not None and empty_when_new(symbol) is not None


def _function_of(collection: SymbolEntry, name: str, reader: BaseReader) -> SymbolEntry | None:
    """The function of that name which the class of a collection has itself."""
    member = reader.entry(f"{TYPES}{collection.collection}.{name}") if collection.collection else None
    return member if member and member.kind == "function" else None


def _first_function(collection: SymbolEntry, names: Iterable[str], reader: BaseReader) -> SymbolEntry | None:
    return next(filter(None, (_function_of(collection, name, reader) for name in names)), None)


def _takes(function: SymbolEntry, cls: str, reader: BaseReader) -> bool:
    """Whether the first that a function wants is an instance of a class."""
    symbol = reader.symbol(function.path)
    return symbol is not None and bool(symbol.parameters) and symbol.parameters[0].type == cls


def _call(function: SymbolEntry, reader: BaseReader) -> str:
    """A call of a function with what it wants."""
    symbol = reader.symbol(function.path)
    wanted = [one.name for one in symbol.parameters if one.required] if symbol else []
    return f"{last_name(function.path)}({', '.join(wanted)})"
