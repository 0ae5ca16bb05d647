"""Finds what a class lacks one step on: on a part of it (``SpaceView3D.overlay`` has ``show_overlays``), on the
elements of its collections, or on what it is the data of.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.symbols.api_names import CONTEXT, ID, OBJECT, STRUCT, TYPES
from kb_serve.recognise.elsewhere.elements import ADDING, REMOVING
from kb_serve.recognise.elsewhere.held_collections import is_none_when_new, members_of
from kb_serve.recognise.elsewhere.layers import in_layers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

OF_ELEMENTS = "The elements of"  # how notes begin on what they have
_FEW = 3
# Parts whose members say what the same names are worth there, how it is drawn, or what is done with it: the weight of
# gravity, the size of a baked image. None of them is what the name means of the thing.
_OF_OTHER_USE = frozenset({"EffectorWeights", "BakeSettings", "VolumeDisplay", "ParticleSettingsTextureSlot"})
# A tree, of which every node is called, placed and drawn: of its nodes only these are asked of what it belongs to.
_TREE, _SOCKETS = "NodeTree", frozenset({"inputs", "outputs"})
_ANIMATION = "AnimData"  # every data-block has one, the elements of which are no part of what it shows
_COUNTS = 1.0  # the weight from which on the data of an object are likely meant by a member of theirs


class Within(NamedTuple):
    """A member that something else has, and a sentence on how it is reached from the class that lacks it."""

    member: SymbolEntry
    note: str


def members_within(owner: str, name: str, reader: BaseReader, *, on_new: bool = False) -> list[Within]:
    """Where a member of exactly that name is, one step from a class; empty where that may be in many places.

    With ``on_new`` only on what new things have themselves, not on what is None there, nor further on. Only parts of
    the thing count: not another object that it points to, nor the one of its elements that is active. What is done to
    anything (``add``, ``remove``) is looked for on no part that every data-block has.
    """
    members = members_of(owner, reader)
    held = {member.target for member in members if member.type == "collection"}
    pointers = [one for one in members if one.type == "pointer" and _is_part(one, owner, held, reader)]
    if name in ADDING | REMOVING:
        pointers = [one for one in pointers if one.owner != ID]
    if on_new:
        pointers = [one for one in pointers if not is_none_when_new(one, reader)]
    found = {
        member: f"Its `.{one.name}` has it: `.{one.name}.{name}` (`{member.path}`)."
        for one in pointers
        if (member := _own_of(f"{TYPES}{one.target}", name, reader))
        and not (member.kind == "function" and reader.descends(f"{TYPES}{one.target}", ID))
    }
    beside = (
        *_of_data(owner, name, reader), *_of_collections(members, name, reader), *in_layers(owner, name, reader)
    )  # fmt: skip
    for member, note in beside:
        found.setdefault(member, note)
    if not found and not on_new:
        for one in pointers:
            if not one.is_read_only or (one.target.endswith(_TREE) and name not in _SOCKETS):
                continue
            if one.target == _ANIMATION:
                continue
            beyond = members_of(f"{TYPES}{one.target}", reader)
            for member, note in _of_collections(beyond, name, reader, f".{one.name}"):
                found.setdefault(member, note)
    if not found and (beside := _beside(owner, name, reader)):
        return [beside]
    return (
        [Within(member, found[member]) for member in reader.usage.heaviest(found)]
        if len(found) <= _FEW
        else []
    )


def of_elements(collection: SymbolEntry, name: str, reader: BaseReader, before: str = "") -> Within | None:
    """The member of that name which the elements of a collection have."""
    member = _own_of(f"{TYPES}{collection.target}", name, reader)
    if member is None:
        return None
    access = f"{before}.{collection.name}"
    return Within(member, f"{OF_ELEMENTS} `{access}` have it: `{access}[0].{name}` (`{member.path}`).")


def _own_of(cls: str, name: str, reader: BaseReader) -> SymbolEntry | None:
    """A class's member of that name, if not everything has it."""
    member = reader.member_of(cls, name)
    return member if member and member.owner != STRUCT else None


def _is_part(pointer: SymbolEntry, owner: str, held: set[str], reader: BaseReader) -> bool:
    """Whether what a pointer of a class leads to is the thing's own: no other object or thing of its kind, and none of
    the elements that it has a collection of.
    """
    target = f"{TYPES}{pointer.target}"
    return bool(pointer.target) and not (
        pointer.target in _OF_OTHER_USE
        or reader.descends(target, OBJECT)
        or reader.descends(owner, target)
        or pointer.target in held
    )


def _of_data(owner: str, name: str, reader: BaseReader) -> Iterator[Within]:
    """The member of the data of an object that scripts use most, of those of that name."""
    if not reader.descends(owner, OBJECT):
        return
    named = [
        one
        for one in reader.names.by_name(name)
        if one.kind == "property" and reader.is_object_data(one.owner)
    ]
    for member in reader.usage.heaviest(named, _COUNTS)[:1]:
        cls = member.owner.removeprefix(TYPES)
        yield Within(
            member, f"Its `.data` has it if that is of class `{cls}`: `.data.{name}` (`{member.path}`)."
        )


def _of_collections(
    members: list[SymbolEntry], name: str, reader: BaseReader, before: str = ""
) -> Iterator[Within]:
    """Members of collections of a class of their own (``objects.active``), and of the elements of collections."""
    for one in members:
        if one.type != "collection" or not one.target or one.target in _OF_OTHER_USE:
            continue
        own = _own_of(f"{TYPES}{one.collection}", name, reader) if one.collection else None
        if own and own.owner == f"{TYPES}{one.collection}":
            access = f"{before}.{one.name}"
            yield Within(own, f"Its `{access}` has it: `{access}.{name}` (`{own.path}`).")
            continue
        element = (
            None if reader.descends(f"{TYPES}{one.target}", ID) else of_elements(one, name, reader, before)
        )
        # What is done to each element further on is not done to the thing.
        if element and not (before and element.member.kind == "function"):
            yield element


def _beside(owner: str, name: str, reader: BaseReader) -> Within | None:
    """The member of an object with such data, of what alone has such a thing or has it under its name
    (``PoseBone.bone``), or of another part of what alone has it.
    """
    if reader.is_object_data(owner) and (member := _own_of(OBJECT, name, reader)):
        return Within(member, f"The object that has such data has it: `obj.{name}` (`{member.path}`).")
    cls = owner.removeprefix(TYPES)
    holding = [one for one in reader.pointing_at(cls) if one.is_read_only and not reader.descends(owner, ID)]
    is_alone = len({one.owner for one in holding}) == 1
    # Beside a data-block: a soft body's cache is its modifier's, though the object has the settings too.
    parts = [one for one in holding if not reader.descends(one.owner, ID)]
    is_only_part = len({one.owner for one in parts}) == 1
    named = [one for one in holding if is_alone or key(one.name) == key(cls)]
    for one in dict.fromkeys((*named, *(parts if is_only_part else ()))):
        if member := _own_of(one.owner, name, reader):
            holder = one.owner.removeprefix(TYPES)
            return Within(member, f"`{holder}` has it (`{member.path}`): this is its `.{one.name}`.")
    # What a whole data-block has beside it is another thing, as an object's force field is for its rigid body; and so
    # is what the context has.
    is_part_too = is_alone and holding[0].owner != CONTEXT and not reader.descends(holding[0].owner, ID)
    for part in reader.members(holding[0].owner).values() if is_part_too else ():
        is_part = part.type == "pointer" and part.is_read_only and part.target not in {cls, *_OF_OTHER_USE}
        if is_part and (member := _own_of(f"{TYPES}{part.target}", name, reader)) and member.owner != ID:
            beside = f"`.{part.name}`, which stands beside this `.{holding[0].name}`"
            return Within(member, f"{beside}, has it (`{member.path}`).")
    return None
