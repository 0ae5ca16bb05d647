"""What Blender makes of a Python value that is given to one of its properties, as tried in Blender.

======================  ==================================================================================
what takes it           what it takes
======================  ==================================================================================
boolean                 bool, and the integers 0 and 1
int                     int, bool
float                   float, int, bool
string                  str; None only where it may have none
enum                    str
enum of flags           a set of str
pointer                 an instance of its class; None unless it must have one
array                   a sequence of its length (not an iterator), each item as above; a boolean's items are
                        bool, an int's int, a float's any number
======================  ==================================================================================
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.facts import OBJECT_DATA, T
from kb_build.flow.types import (
    NONE,
    Collection,
    Instance,
    Mapping,
    Module,
    Plain,
    Sequence,
    Tuple,
    Type,
    members,
)
from kb_check.literals import items, number, written
from kb_check.made_here import alias

if TYPE_CHECKING:
    from kb_check.given import Taker
    from kb_check.script import Script

# How many numbers a class always has.
LENGTHS = {"mathutils.Color": 3, "mathutils.Euler": 3, "mathutils.Quaternion": 4}
_AXIS = 3  # numbers that a quaternion is made of besides its own four
_BMESH_VECTOR = re.compile(r"tuple\[(float(?:, float)+)\] \| Sequence\[float\]")
_BMESH_TYPES = "bmesh.types."
# What the methods of bmesh's classes take: ``bpy.types.Mesh``, ``Sequence[bmesh.types.BMVert]``.
_BMESH_CLASS = re.compile(r"(?P<many>Sequence\[)?(?P<cls>(bpy|bmesh)\.types\.\w+)(?(many)\])( \| None)?")
_OBJECTS_DATA = f"{T}Object.data"
_ID = f"{T}ID"
_MADE_OF = f"{T}BlendDataObjects.new(object_data)"
_DATA_OF_NEW = tuple(f"{T}{name}" for name in OBJECT_DATA.values())
_DATA = (*_DATA_OF_NEW, f"{T}Image")  # an empty shows images
_NUMBERS = frozenset({"bool", "int", "float"})
_TAKES = {
    "boolean": frozenset({"bool", "int"}), "int": frozenset({"int", "bool"}), "float": _NUMBERS,
    "string": frozenset({"str"}), "enum": frozenset({"str"}), "enum or set": frozenset({"str"}),
}  # fmt: skip
_ITEM_TAKES = {"boolean": frozenset({"bool"}), "int": frozenset({"int", "bool"}), "float": _NUMBERS}
_WORDS = {
    "boolean": "True or False", "int": "an int", "float": "a number", "string": "a str", "enum": "a str",
    "enum or set": "a str", "set": "a set of str",
}  # fmt: skip
_ITEM_WORDS = {"boolean": "bool", "int": "int", "float": "float"}
# Documented types that surely refuse others: what each takes. ``bool`` takes anything, as Python does.
_DOCUMENTED = {"str": frozenset({"str"}), "string": frozenset({"str"}), "float": _NUMBERS, "int": _NUMBERS}
# The operators of bmesh convert nothing: every parameter of each was given the others.
_OF_BMESH = {
    **_DOCUMENTED, "enum": frozenset({"str"}), "int": frozenset({"int", "bool"}), "bool": frozenset({"bool", "int"}),
}  # fmt: skip
# The parts of documented types of mathutils that are sequences of numbers.
_OF_MATHUTILS = frozenset({"Vector", "Quaternion", "Euler", "Matrix", "Color", "Sequence[float]", "None"})
_BMESH_WORDS = {"int": "an int", "bool": "True or False"}
# Arrays whose size is not the one that RNA declares.
CHANGING_ARRAYS = frozenset({"bpy.types.FModifierGenerator.coefficients", "bpy.types.MeshPolygon.vertices"})


@dataclass(frozen=True, slots=True)
class Misfit:
    """A value that Blender refuses: what it takes, and what is given, in words. ``length`` is a wrong one."""

    takes: str
    given: str
    length: int = 0


def misfit(script: Script, taker: Taker, node: ast.expr) -> Misfit | None:
    """Why a property or parameter surely refuses a value; None where it takes it, or may."""
    if taker.sizes:
        return _array_misfit(script, taker, node, taker.sizes)
    if (lengths := _lengths(taker)) and (found := _length_misfit(script, node, lengths)):
        return found
    kind = script.type_of(node)
    if kind is None:
        return None
    if isinstance(written(script, node), ast.Constant) and kind == NONE:
        may_be_none = not taker.kind or (
            taker.takes_none and taker.kind in {"string", "pointer", "enum or set"}
        )
        return None if may_be_none else Misfit(_takes(taker), "None")
    found = [_scalar_misfit(script, taker, node, member) for member in members(kind)]
    return found[0] if all(found) else None


def _lengths(taker: Taker) -> tuple[int, ...]:
    """How many numbers a parameter takes whose sequence no array of RNA's tells; none where any number may be right.

    It is the first of what makes one of mathutils' values, or one of bmesh's.
    """
    symbol = taker.symbol
    if symbol.kind == "class" and symbol.path in LENGTHS:
        is_first = taker.path == f"{symbol.path}({symbol.parameters[0].name})"
        return tuple(sorted({_AXIS, LENGTHS[symbol.path]})) if is_first else ()
    found = _BMESH_VECTOR.fullmatch(taker.documented) if taker.path.startswith("bmesh.") else None
    return (found[1].count("float"),) if found else ()


def _length_misfit(script: Script, node: ast.expr, lengths: tuple[int, ...]) -> Misfit | None:
    takes = f"{' or '.join(map(str, lengths))} numbers"
    if (parts := items(script, node)) is not None:
        return None if len(parts) in lengths else Misfit(takes, f"{len(parts)} items", len(parts))
    kind = script.type_of(node)
    has = LENGTHS.get(kind.cls, 0) if isinstance(kind, Instance) and kind.sure else 0
    return (
        Misfit(takes, f"{describe(kind)}, which has {has}", has)
        if kind and has and has not in lengths
        else None
    )


def _scalar_misfit(  # noqa: PLR0911 - one return a type
    script: Script, taker: Taker, node: ast.expr, kind: Type
) -> Misfit | None:
    if kind == NONE:
        return None  # what holds None here may hold a value by then
    if isinstance(kind, Instance) and not kind.sure:
        return None  # a parameter that is called ``mat`` may hold the name of a material
    if not taker.kind:
        return _documented_misfit(taker, kind) or _class_misfit(script, taker, node, kind)
    given = describe(kind)
    if not given:
        return None
    if taker.kind == "pointer":
        if _is_other_data(script, taker, node, kind):
            return Misfit(_takes(taker), "the data of an object")
        return _pointer_misfit(script, taker, kind, given)
    if isinstance(kind, Plain):
        if taker.kind == "set":
            return Misfit(_takes(taker), given)
        value = number(script, node)
        if taker.kind == "boolean" and kind.kind == "int" and value not in {None, 0, 1}:
            return Misfit(_takes(taker), f"{value}")
        fits = kind.kind in _TAKES[taker.kind] or (kind.kind == "bytes" and taker.subtype == "BYTE_STRING")
        return None if fits else Misfit(_takes(taker), _shown(script, node, given))
    if isinstance(kind, Sequence) and kind.kind == "set" and taker.kind in {"set", "enum or set"}:
        return None
    return Misfit(_takes(taker), given)


def _is_other_data(script: Script, taker: Taker, node: ast.expr, kind: Type) -> bool:
    """Whether a value is an object's data, declared as any data-block, where none of those that objects have fits."""
    row = script.analysis.resolutions.get(alias(script, node))
    if row is None or row.symbols != (_OBJECTS_DATA,) or not row.sure or row.missing or kind != Instance(_ID):
        return False
    api, target = script.api, taker.target
    related = any(_is_related(script, cls, target) for cls in _DATA)
    return not related and api.is_class(target) and api.descends(target, _ID)


def _pointer_misfit(script: Script, taker: Taker, kind: Type, given: str) -> Misfit | None:
    api = script.api
    if not api.is_class(taker.target) or api.descends(taker.target, "bpy.types.PropertyGroup"):
        return None
    if isinstance(kind, Instance):
        if not api.is_class(kind.cls):
            return None
        if classes := {_OBJECTS_DATA: _DATA, _MADE_OF: _DATA_OF_NEW}.get(taker.path):
            is_data = any(_is_related(script, kind.cls, cls) for cls in classes)
            return None if is_data else Misfit("the data of an object", given)
        if _is_related(script, kind.cls, taker.target):
            return None
    if isinstance(kind, Collection):
        return None
    return Misfit(_takes(taker), given)


def _is_related(script: Script, cls: str, other: str) -> bool:
    """Whether something of a class may be of another one."""
    return script.api.descends(cls, other) or script.api.descends(other, cls)


def _array_misfit(script: Script, taker: Taker, node: ast.expr, sizes: tuple[int, ...]) -> Misfit | None:
    changing = not all(sizes) or taker.path in CHANGING_ARRAYS
    many = "a sequence of" if changing else " × ".join(map(str, sizes))
    takes = f"{many} {_ITEM_WORDS.get(taker.kind, taker.kind)}s"
    if (parts := items(script, node)) is not None:
        if not changing and len(parts) != sizes[0]:
            return Misfit(takes, f"{len(parts)} items", len(parts))
        if len(sizes) > 1:
            inner = (_array_misfit(script, taker, part, sizes[1:]) for part in parts)
            return next((Misfit(takes, f"items that are {one.given}") for one in inner if one), None)
        return next((found for part in parts if (found := _item_misfit(script, taker, part, takes))), None)
    kind = script.type_of(node)
    if kind is None:
        return None
    length = 0 if changing else sizes[0] if len(sizes) == 1 else -1
    found = [_whole_misfit(script, node, member, length, takes) for member in members(kind)]
    return found[0] if all(found) else None


def _item_misfit(script: Script, taker: Taker, node: ast.expr, takes: str) -> Misfit | None:
    kind = script.type_of(node)
    kinds = list(members(kind)) if kind is not None else []
    fits = _ITEM_TAKES.get(taker.kind, frozenset())
    wrong = [
        isinstance(one, (Tuple, Sequence, Mapping, Collection))
        or (isinstance(one, Instance) and one.sure)
        or (one == NONE and isinstance(written(script, node), ast.Constant))
        or (isinstance(one, Plain) and one.kind not in fits)
        for one in kinds
    ]  # fmt: skip
    if kind is None or not fits or not all(wrong):
        return None
    return Misfit(takes, f"an item that is {_shown(script, node, describe(members(kind)[0]) or 'None')}")


def _whole_misfit(script: Script, node: ast.expr, kind: Type, length: int, takes: str) -> Misfit | None:
    """Why an array of a length refuses a value that is not written out; 0 is a length that changes, -1 an array of
    arrays.
    """
    if kind == NONE:
        return Misfit(takes, "None") if isinstance(written(script, node), ast.Constant) else None
    given = describe(kind)
    if isinstance(kind, Mapping) or (isinstance(kind, Plain) and kind.kind != "bytes"):
        return Misfit(takes, _shown(script, node, given))
    if isinstance(kind, Instance):
        has = LENGTHS.get(kind.cls, 0)
        if has and length and length != has:
            return Misfit(takes, f"{given}, which has {has}", has)
        if kind.sure and kind.cls.startswith("bpy.types.") and not kind.cls.startswith("bpy.types.bpy_"):
            return Misfit(takes, given)
    return None


def _documented_misfit(taker: Taker, kind: Type) -> Misfit | None:
    """A value that no reading of the reference allows: text for a number, a number for text, either for a vector."""
    if taker.path.startswith("mathutils.") and _OF_MATHUTILS.issuperset(_parts(taker.documented)):
        is_refused = isinstance(kind, Plain) and kind.kind != "bytes"
        return Misfit("a sequence of numbers", describe(kind)) if is_refused else None
    strict = _OF_BMESH if taker.path.startswith("bmesh.ops.") else _DOCUMENTED
    fits = strict.get(taker.documented)
    if fits is None or not isinstance(kind, Plain) or kind.kind in fits:
        return None
    takes = _BMESH_WORDS.get(taker.documented, "") if strict is _OF_BMESH else ""
    return Misfit(takes or ("a str" if "str" in fits else "a number"), describe(kind))


def _class_misfit(script: Script, taker: Taker, node: ast.expr, kind: Type) -> Misfit | None:
    """A value that a method of bmesh's refuses, which takes instances of one class, or a sequence of them."""
    is_of_bmesh = taker.is_parameter and taker.path.startswith(_BMESH_TYPES)
    found = _BMESH_CLASS.fullmatch(taker.documented) if is_of_bmesh else None
    if found is None:
        return None
    cls, takes = found["cls"], f"an instance of `{found['cls']}`"
    if not found["many"]:
        return Misfit(takes, describe(kind)) if _is_no_instance(script, kind, cls) else None
    takes = f"a sequence of instances of `{cls}`"
    if isinstance(kind, Plain) or (isinstance(kind, Instance) and script.api.descends(kind.cls, cls)):
        return Misfit(takes, describe(kind))
    for part in items(script, node) or ():
        of = script.type_of(part)
        if of is not None and _is_no_instance(script, of, cls):
            return Misfit(takes, f"an item that is {_shown(script, part, describe(of))}")
    return None


def _is_no_instance(script: Script, kind: Type, cls: str) -> bool:
    """Whether a value surely is none of a class's instances."""
    if isinstance(kind, Instance):
        known = kind.sure and script.api.is_class(kind.cls) and script.api.is_class(cls)
        return known and not _is_related(script, kind.cls, cls)
    return isinstance(kind, (Plain, Tuple, Sequence, Mapping))


def _parts(documented: str) -> list[str]:
    return documented.replace("mathutils.", "").split(" | ")


def _takes(taker: Taker) -> str:
    if taker.kind == "pointer":
        return f"an instance of `{taker.target}`"
    return _WORDS[taker.kind]


def _shown(script: Script, node: ast.expr, otherwise: str) -> str:
    value = written(script, node)
    if isinstance(value, ast.Constant) or number(script, value) is not None:
        text = ast.unparse(value)
        return text if len(text) <= 40 else otherwise
    return otherwise


def describe(kind: Type) -> str:  # noqa: PLR0911 - one return a type
    """A type in words: ``a float``; empty for what may be anything."""
    match kind:
        case Plain():
            return f"{'an' if kind.kind == 'int' else 'a'} {kind.kind}"
        case Instance():
            return f"an instance of `{kind.cls}`"
        case Collection():
            return "a collection"
        case Tuple():
            return "a sequence"
        case Sequence():
            return {"set": "a set"}.get(kind.kind, "a sequence")
        case Mapping():
            return "a dict"
        case Module():
            return "a module"
        case _:
            return ""
