"""Data paths: texts by which Blender finds a property from a struct, as ``modifiers["Array"].count``.

They are read as Python's attributes and items are, but that keys stand in double quotes.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import DERIVED_BY_SCRIPTS, OPEN_CLASSES
from kb_build.flow.values.types import NONE, UNKNOWN, Collection, Instance, Type, members
from kb_build.symbols.api_names import ID
from kb_build.symbols.records import SCALAR_TYPES
from kb_build.symbols.unlisted import SOMETIMES
from kb_check.calls.sites import calls
from kb_check.scene.made_here import is_new
from kb_check.script import once_per_script
from kb_check.values.lengths import CHANGING_ARRAYS

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_PART = re.compile(r'(?P<dot>\.?)(?P<name>[A-Za-z_]\w*)|\["(?P<key>(?:[^"\\]|\\.)*)"\]|\[\d+\]')
_MISQUOTED = re.compile(r"\['[^'\"]*'\]")
_ITEM = re.compile(r"\.([a-z])|\[(\d+)\]")
_UNBOUND = 32  # the length that RNA gives to arrays which have any
# The letters of the items of arrays, by what these are. Blender takes those of a vector for all others.
_LETTERS = {"COLOR": "rgba", "COLOR_GAMMA": "rgba", "QUATERNION": "wxyz", "AXISANGLE": "wxyz"}
_LETTERS_OF_VECTORS = "xyzw"


@dataclass(frozen=True, slots=True)
class Followed:
    """Where a path leads.

    ``properties`` are what it can end at, one for each class that its owner can have, and ``rest`` what stands behind
    them, an item of an array. ``crossing`` is the place in the text where it enters another data-block, 0 for none.
    A path that leads nowhere has a ``name`` that none of the ``lacking`` classes has, or is ``misquoted``. One that
    asks for a custom property ends at the classes that are ``keyed``, and ``rest`` begins with the key.
    """

    properties: tuple[Symbol, ...] = ()
    rest: str = ""
    crossing: int = 0
    lacking: tuple[str, ...] = ()
    name: str = ""
    misquoted: bool = False
    keyed: tuple[str, ...] = ()


def follow(script: Script, owner: ast.expr, path: str) -> Followed:
    """Follows a path from the struct that an expression is, as far as is known."""
    kinds = [kind for kind in members(script.type_of(owner) or UNKNOWN) if kind != NONE]
    properties: tuple[Symbol, ...] = ()
    keyed: tuple[str, ...] = ()
    place, crossing, rest = 0, 0, ""
    while place < len(path):
        if properties and all(symbol.type in SCALAR_TYPES for symbol in properties):
            return Followed(properties, path[place:], crossing)
        if place and not crossing and kinds and all(_is_data_block(script, kind) for kind in kinds):
            crossing = place
        part = _PART.match(path, place)
        if part is None or (part["name"] and bool(part["dot"]) != bool(place)):
            return Followed(crossing=crossing, misquoted=bool(_MISQUOTED.match(path, place)))
        place = part.end()
        if part["name"]:
            known = _members(script, kinds, part["name"])
            if known is None:
                return Followed(crossing=crossing)
            if not known:
                lacking = tuple(kind.cls for kind in kinds if isinstance(kind, Instance))
                return Followed(crossing=crossing, lacking=lacking, name=part["name"])
            properties, kinds = tuple(symbol for symbol, _ in known), [kind for _, kind in known]
        else:
            made = _made(script, owner, path[: part.start()], part["key"])
            keyed = tuple(
                kind.cls for kind in kinds if isinstance(kind, Instance) and kind.sure and part["key"]
            )
            rest = path[part.start() :] if keyed else ""
            kinds = [made or kind.element for kind in kinds if isinstance(kind, Collection)]
        if not kinds:
            return Followed((), rest, crossing, keyed=keyed)
    return Followed(properties, "", crossing)


def _made(script: Script, owner: ast.expr, collection: str, key: str | None) -> Type | None:
    """What the script itself makes in a collection of what is new, under the name that is the key."""
    if not key or not is_new(script, owner):
        return None
    kinds = _made_by_name(script).get((f"{ast.unparse(owner)}.{collection}", key), set())
    return next(iter(kinds)) if len(kinds) == 1 else None


@once_per_script
def _made_by_name(script: Script) -> dict[tuple[str, str], set[Type | None]]:
    """Collection as it is written, and a name → the types of what the script makes there under that name."""
    found: dict[tuple[str, str], set[Type | None]] = {}
    for call in calls(script):
        name = call.argument("name")
        match call.node.func:
            case ast.Attribute(attr="new", value=collection) if isinstance(name, ast.Constant):
                if isinstance(name.value, str):
                    key = ast.unparse(collection), name.value
                    found.setdefault(key, set()).add(script.type_of(call.node))
            case _:
                pass
    return found


def _is_data_block(script: Script, kind: Type) -> bool:
    return isinstance(kind, Instance) and script.api.descends(kind.cls, ID)


def _members(script: Script, kinds: list[Type], name: str) -> list[tuple[Symbol, Type]] | None:
    """What classes have under a name, themselves or below them; None where they may have what is not known."""
    found: list[tuple[Symbol, Type]] = []
    for kind in kinds:
        if not isinstance(kind, Instance) or not kind.sure or not script.api.is_class(kind.cls):
            return None
        own = script.api.member(kind.cls, name)
        below = [member for _, member in script.api.below(kind.cls, name)] if own is None else [own]
        found += ((member.symbol, member.type) for member in below)
        if not below and _may_have(script, kind.cls, name):
            return None
    return found


def _may_have(script: Script, cls: str, name: str) -> bool:
    """Whether instances of a class may have a member that the base lacks."""
    return (
        cls in DERIVED_BY_SCRIPTS
        or cls in SOMETIMES
        or any(script.api.descends(cls, base) for base in OPEN_CLASSES)
        or script.package.has((cls,), name)
    )


def size(symbol: Symbol) -> int | None:
    """How many values a property has, 0 for one that is no array; None where instances differ in that."""
    total = 1 if symbol.array else 0
    for length in symbol.array:
        total *= length
    is_known = not symbol.array or (0 < total < _UNBOUND and symbol.path not in CHANGING_ARRAYS)
    return total if is_known else None


def item(symbol: Symbol, rest: str) -> int | None:
    """The index that ``.x`` or ``[0]`` behind a property means; None if it is no item of an array of one dimension."""
    found = _ITEM.fullmatch(rest)
    if found is None or len(symbol.array) != 1:
        return None
    letters = _LETTERS.get(symbol.subtype, _LETTERS_OF_VECTORS)
    index = letters.find(found[1]) if found[1] else int(found[2])
    return index if 0 <= index < (size(symbol) or 0) else None
