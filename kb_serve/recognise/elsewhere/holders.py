"""What is done to a thing by what holds it: ``modifier.remove()`` is ``obj.modifiers.remove(modifier)``, and
``collection.append(obj)`` is ``collection.objects.link(obj)``.

Python's lists and other programs teach such methods; in Blender the collections of things have them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, stems_of, words
from kb_build.symbols.api_names import BLEND_DATA, STRUCT
from kb_build.symbols.paths import last_name
from kb_serve.recognise.elsewhere.elements import ADDED_BY, REMOVED_BY, REMOVING, Elsewhere
from kb_serve.recognise.elsewhere.held_collections import (
    BMESH,
    BMESH_TYPES,
    Held,
    call_of,
    class_of,
    collections_with,
    first_function,
    function_of,
    held_by,
    held_with,
    of_owner,
    takes,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_FEW = 3
_VALUES = "mathutils."
_BMESH_OPS = "bmesh.ops."
_TAKING_OUT = frozenset({"discard", "pop", "remove", "unlink"})
_REMOVING = REMOVING | {"detach", "disconnect", "dispose", "kill", "purge"}
_PUTTING = frozenset({"add", "append", "attach", "connect", "insert", "link", "push", "put"})
_MAKING = frozenset({"create", "make", "new"})
_ALL_AT_ONCE = "clear"  # empties a thing, unless it says of what
_REMOVERS, _TAKERS, _MAKERS = ("remove", "unlink"), ("link", "append"), ("insert", "new", "add", "load")
_OUT, _IN = ("unlink", "unassign"), ("assign",)  # of a thing with what it does not own
_OF_A_KIND = "new_"  # makes elements of one kind: ``strips.new_image``
# What a verb is about: ``socket.connect``.
_ABOUT: dict[str, str] = dict.fromkeys(("connect", "disconnect", "unlink"), "link")
_SHORT = {"vertex": "vert", "vertices": "verts"}
_DOES = {
    **dict.fromkeys(_OUT, "lets go of one"),
    **dict.fromkeys((*_TAKERS, *_IN), "takes one"),
    **dict.fromkeys(_MAKERS, "makes one"),
}
_ON_VALUES = frozenset({"driver_add", "driver_remove", "keyframe_delete", "keyframe_insert"})


def by_what_holds_it(owner: str, name: str, reader: BaseReader) -> list[Elsewhere]:
    """What does to instances of a class, or to what they hold, what a name says that the class lacks; the likeliest
    first, and none for what is no verb for that.
    """
    entry = reader.entry(owner)
    if entry is None or entry.kind != "class" or entry.group != "data":
        return []
    if owner.startswith(_VALUES):
        return _of_a_value(name, reader)
    verb, *what = words(name) or [""]
    operator = reader.entry(_BMESH_OPS + name) if owner == BMESH else None
    if operator:
        found = [Elsewhere(operator.path, f"An operator does it: `{call_of(operator, reader, _BMESH_OPS)}`.")]
    elif what:
        is_verb = verb in _REMOVING | _PUTTING | _MAKING and not _says_the_same(owner, name, reader)
        found = _of_named(owner, verb, what, reader) if is_verb else []
    elif verb in _REMOVING and verb != _ALL_AT_ONCE:
        held = list(held_by(owner, reader))
        about = _done(_of_the_verb(held, verb), _REMOVERS, REMOVED_BY, reader)
        found = about or [*_let_go(held, verb, reader), *_removed(owner, verb, reader)]
    elif verb in _MAKING:
        found = _made(owner, reader)
    else:
        found = _put(owner, verb, reader) if verb in _PUTTING else []
    return list(dict.fromkeys(found))[:_FEW]


def of_collection(path: str, name: str, reader: BaseReader) -> list[Elsewhere]:
    """What does to a collection, a property, what it has no function for: the thing that has it."""
    collection = reader.entry(path)
    if collection is None or collection.type != "collection" or collection.collection:
        return []
    wanted = (*_OUT, *_REMOVERS) if name in _REMOVING else ()
    if name in _PUTTING | _MAKING:
        wanted = (*_IN, *_MAKERS)
    function = of_owner(collection, wanted, reader)
    if function is None:
        return []
    owner, does = last_name(collection.owner), _DOES.get(function.name, "removes one")
    how = f"The `{owner}` that has it {does}: `.{call_of(function, reader)}` (`{function.path}`)."
    return [Elsewhere(function.path, how)]


def _says_the_same(owner: str, name: str, reader: BaseReader) -> bool:
    """Whether a class has a member of the same words: ``shape_key_add``, who says ``add_shape_key``."""
    said = stems_of(name)
    return any(stems_of(own) == said for own in reader.member_names(owner))


def _of_a_value(name: str, reader: BaseReader) -> list[Elsewhere]:
    """What animates a value, which has no such functions itself: the thing whose property it is."""
    function = reader.entry(f"{STRUCT}.{name}") if name in _ON_VALUES else None
    how = f'The thing whose property it is does it, by the name of that: `obj.{name}("location")`.'
    return [Elsewhere(function.path, how)] if function else []


def _let_go(held: Iterable[tuple[SymbolEntry, str]], verb: str, reader: BaseReader) -> list[Elsewhere]:
    """How things that do not own what they hold let go of it, where the verb may mean that."""
    return list(map(_told, _having(held, _OUT, reader))) if verb in _TAKING_OUT else []


def _made(owner: str, reader: BaseReader) -> list[Elsewhere]:
    """How instances of a class are made, or else its elements."""
    if creation := reader.makers.creations([owner]).get(owner):
        return [Elsewhere(creation.maker, f"One is made by `{creation.call}` (`{creation.maker}`).")]
    return _put(owner, "", reader)


def _put(owner: str, verb: str, reader: BaseReader) -> list[Elsewhere]:
    """How something is put into a thing: into what is called as the verb, or takes what there is, or makes it."""
    held = list(held_by(owner, reader))
    if about := _done(_of_the_verb(held, verb), (*_TAKERS, *_MAKERS), ADDED_BY, reader):
        return about
    if taken := _having(held, (*_TAKERS, *_IN), reader):
        return list(map(_told, taken))
    own = [(collection, access) for collection, access in held if "." not in access]
    made = _done(own, _MAKERS, ADDED_BY, reader)
    weights = reader.usage.weights([one.path for one in made])
    made.sort(key=lambda one: -weights.get(one.path, 0.0))
    return made if len(made) <= _FEW else []


def _of_the_verb(held: Iterable[tuple[SymbolEntry, str]], verb: str) -> list[tuple[SymbolEntry, str]]:
    """Those of some collections that are called as what a verb does: ``links``, of who says ``link``."""
    said = stem(_ABOUT.get(verb, verb))
    return [(one, access) for one, access in held if stem(one.name) == said]


def _of_named(owner: str, verb: str, what: Sequence[str], reader: BaseReader) -> list[Elsewhere]:
    """What is done to the elements that are named behind the verb."""
    is_removed = verb in _REMOVING
    wanted = (*_REMOVERS, *_OUT) if is_removed else (*_TAKERS, *_MAKERS, *_IN)
    table = REMOVED_BY if is_removed else ADDED_BY
    if found := _done(_called(owner, what, reader), wanted, table, reader):
        return found
    kind = _OF_A_KIND + "_".join(what)
    return [] if is_removed else list(map(_told, _having(held_by(owner, reader), (kind,), reader)))


def _removed(owner: str, verb: str, reader: BaseReader) -> list[Elsewhere]:
    """How instances of a class are removed from what holds them: for good before out of something, but that first which
    is called as the verb.
    """
    found: list[Held] = []
    others: list[Elsewhere] = []
    for cls in reader.lineage(owner):
        for collection in collections_with(cls, reader):
            own = [*filter(None, (function_of(collection, name, reader) for name in _REMOVERS))]
            functions = own or [*filter(None, [of_owner(collection, _REMOVERS, reader)])]
            found += (
                held_with(collection, collection.name, function, reader)
                for function in functions
                if takes(function, cls, reader)
            )
            others += filter(None, (REMOVED_BY.get(collection.path),))
    weights = reader.usage.weights([one.collection.path for one in found])

    def order(one: Held) -> tuple[bool, bool, float]:
        is_other = verb in _REMOVERS and one.function.name != verb
        return is_other, one.collection.owner != BLEND_DATA, -weights.get(one.collection.path, 0.0)

    return [_removal(held) for held in sorted(found, key=order)] or list(dict.fromkeys(others))


def _removal(held: Held) -> Elsewhere:
    """How what holds a thing removes it."""
    path = held.function.path
    does = "lets go of it" if held.function.name in _OUT else "removes it"
    if held.collection.owner == BLEND_DATA:
        return Elsewhere(path, f"`bpy.data.{held.call}` {does} (`{path}`).")
    holder = last_name(held.collection.owner)
    return Elsewhere(path, f"The `{holder}` that holds it {does}: `.{held.call}` (`{path}`).")


def _done(
    held: Iterable[tuple[SymbolEntry, str]],
    wanted: Sequence[str],
    table: Mapping[str, Elsewhere],
    reader: BaseReader,
) -> list[Elsewhere]:
    """What collections do by the first of some functions, or what does it for them."""
    found: list[Elsewhere] = []
    for collection, access in held:
        if function := first_function(collection, wanted, reader):
            found.append(_told(held_with(collection, access, function, reader)))
        elif (other := table.get(collection.path)) and reader.entry(other.path):
            found.append(other)
        elif wanted[-1] in (*_MAKERS, *_IN):
            found += (
                _told(held_with(collection, access, one, reader)) for one in _kinds_made(collection, reader)
            )
    return list(dict.fromkeys(found))


def _kinds_made(collection: SymbolEntry, reader: BaseReader) -> list[SymbolEntry]:
    """The functions of a collection that make elements of one kind each, the most used first."""
    members = reader.members(class_of(collection)).values() if collection.collection else ()
    return reader.usage.heaviest(one for one in members if one.name.startswith(_OF_A_KIND))[:_FEW]


def _having(held: Iterable[tuple[SymbolEntry, str]], wanted: Sequence[str], reader: BaseReader) -> list[Held]:
    """The collections with one of some functions, most used first; none where there are too many to tell."""
    found = [
        held_with(collection, access, function, reader)
        for collection, access in held
        if (function := first_function(collection, wanted, reader))
    ]
    weights = reader.usage.weights([one.function.path for one in found])
    found.sort(key=lambda one: -weights.get(one.function.path, 0.0))
    return found if len(found) <= _FEW else []


def _told(held: Held) -> Elsewhere:
    """What a collection of a thing does."""
    name, path = held.function.name, held.function.path
    does = "makes one" if name.startswith(_OF_A_KIND) else _DOES.get(name, "removes one")
    whole = f"bpy.data.{held.call}" if held.collection.owner == BLEND_DATA else f".{held.call}"
    return Elsewhere(path, f"Its `.{held.access}` {does}: `{whole}` (`{path}`).")


def _called(owner: str, what: Sequence[str], reader: BaseReader) -> list[tuple[SymbolEntry, str]]:
    """Those of the collections of a thing whose name, or whose elements' class, says most nearly what is meant: by its
    last word rather than by another one, and with the fewest words besides.
    """
    is_bmesh = owner.startswith(BMESH_TYPES)
    said = stems_of(" ".join(_SHORT.get(word, word) if is_bmesh else word for word in what))
    found: dict[tuple[SymbolEntry, str], tuple[bool, int]] = {}
    for collection, access in held_by(owner, reader, empty=True):
        names = [words(name) for name in (collection.name, collection.target)]
        far = [(stem(name[-1]) not in said, len(name)) for name in names if said <= set(map(stem, name))]
        if far:
            found[collection, access] = min(far)
    return [held for held, far in found.items() if far == min(found.values())][:_FEW]
