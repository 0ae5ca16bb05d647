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
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import OF_OBJECT
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
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
from kb_build.symbols.api_names import ID, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA, OF_EMPTIES
from kb_check.syntax.literals import items, number, written
from kb_check.values.documented import (
    LENGTHS,
    documented_misfit,
    is_related,
    length_misfit,
    lengths,
    none_misfit,
)
from kb_check.values.lengths import CHANGING_ARRAYS, is_iterator, length_of
from kb_check.values.mathutils_sizes import in_words, size_of
from kb_check.values.misfits import Misfit, describe, shown

if TYPE_CHECKING:
    from kb_check.script import Script
    from kb_check.values.given import Taker

_OBJECTS_DATA = f"{T}Object.data"
_MADE_OF = f"{T}BlendDataObjects.new(object_data)"
_DATA_OF_NEW = tuple(f"{T}{name}" for name in OBJECT_DATA.values())
_DATA = (*_DATA_OF_NEW, f"{T}{OF_EMPTIES}")
# Where there is the newer one, objects have that only.
_OLDER, _NEWER = f"{T}GreasePencil", f"{T}GreasePencilv3"
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
_BYTES = "BYTE_STRING"
_ITEM_WORDS = {"boolean": "bool", "int": "int", "float": "float"}


def misfit(  # noqa: PLR0911 - one return a reason
    script: Script, taker: Taker, node: ast.expr
) -> Misfit | None:
    """Why a property or parameter surely refuses a value; None where it takes it, or may."""
    if taker.sizes:
        return _array_misfit(script, taker, node, taker.sizes)
    if (sizes := lengths(taker)) and (found := length_misfit(script, node, sizes)):
        return found
    kind = script.type_of(node)
    if kind is None:
        return None
    if taker.kind == "int" and kind is UNKNOWN and _is_quotient(script, node):
        return Misfit(_takes(taker), "a float")
    if isinstance(written(script, node), ast.Constant) and kind == NONE:
        if not taker.kind:
            return none_misfit(script, taker)
        may_be_none = taker.takes_none and taker.kind in {"string", "pointer", "enum or set"}
        return None if may_be_none else Misfit(_takes(taker), "None")
    found = [_scalar_misfit(script, taker, node, member) for member in members(kind)]
    return found[0] if all(found) else None


def _is_quotient(script: Script, node: ast.expr) -> bool:
    """Whether a value is divided by a number, or divides one: no number that Python has gives an int so."""
    match node:
        case ast.BinOp(op=ast.Div(), left=left, right=right):
            return number(script, left) is not None or number(script, right) is not None
        case _:
            return False


def kind_misfit(taker: Taker, kind: Type) -> Misfit | None:
    """Why a property surely refuses a value of which nothing but its type is known."""
    if taker.sizes or not taker.kind:
        return None
    found = [_of_type(taker, member) for member in members(kind)]
    return found[0] if found and all(found) else None


def _of_type(taker: Taker, kind: Type) -> Misfit | None:
    if not isinstance(kind, Plain) or taker.kind == "pointer" or not describe(kind):
        return None
    if taker.kind == "set":
        return Misfit(_takes(taker), describe(kind))
    takes = _TAKES[taker.kind] if taker.subtype != _BYTES else {"bytes"}
    return None if kind.kind in takes else Misfit(_takes(taker), describe(kind))


def _scalar_misfit(  # noqa: PLR0911 - one return a type
    script: Script, taker: Taker, node: ast.expr, kind: Type
) -> Misfit | None:
    if kind == NONE:
        return None  # what holds None here may hold a value by then
    if isinstance(kind, Instance) and not kind.sure:
        return None  # a parameter that is called ``mat`` may hold the name of a material
    if not taker.kind:
        return documented_misfit(script, taker, node, kind)
    given = describe(kind)
    if not given:
        return None
    if taker.kind == "pointer":
        if _is_other_data(script, taker, kind):
            return Misfit(_takes(taker), "the data of an object")
        return _pointer_misfit(script, taker, kind, given)
    if isinstance(kind, Plain):
        if taker.kind == "set":
            return Misfit(_takes(taker), given)
        value = number(script, node)
        if taker.kind == "boolean" and kind.kind == "int" and value not in {None, 0, 1}:
            return Misfit(_takes(taker), f"{value}")
        takes = _TAKES[taker.kind] if taker.subtype != _BYTES else {"bytes"}
        fits = kind.kind in takes
        return None if fits else Misfit(_takes(taker), shown(script, node, given))
    if isinstance(kind, Sequence) and kind.kind == "set" and taker.kind in {"set", "enum or set"}:
        return None
    return Misfit(_takes(taker), given)


def _is_other_data(script: Script, taker: Taker, kind: Type) -> bool:
    """Whether a value is an object's data, declared as any data-block, where none of those that objects have fits."""
    if not isinstance(kind, Instance) or kind.trait(OF_OBJECT) is None:
        return False
    api, target = script.api, taker.target
    related = any(is_related(script, cls, target) for cls in _DATA)
    return not related and api.is_class(target) and api.descends(target, ID)


def _pointer_misfit(script: Script, taker: Taker, kind: Type, given: str) -> Misfit | None:
    api = script.api
    if not api.is_class(taker.target) or api.descends(taker.target, "bpy.types.PropertyGroup"):
        return None
    if isinstance(kind, Instance):
        if not api.is_class(kind.cls):
            return None
        if classes := {_OBJECTS_DATA: _DATA, _MADE_OF: _DATA_OF_NEW}.get(taker.path):
            return _data_misfit(script, taker, kind, classes)
        if is_related(script, kind.cls, taker.target):
            return None
    # A name may be a module's and the script's own where only a part of the script is seen.
    if isinstance(kind, Collection) or (isinstance(kind, Module) and taker.target == STRUCT):
        return None
    return Misfit(_takes(taker), given)


def _data_misfit(script: Script, taker: Taker, kind: Instance, classes: tuple[str, ...]) -> Misfit | None:
    """Why what takes an object's data, of some classes, surely refuses an instance."""
    if taker.path == _MADE_OF and kind.cls == _OLDER and script.api.is_class(_NEWER):
        return Misfit(f"an instance of `{_NEWER}`, which `bpy.data.grease_pencils_v3` makes", describe(kind))
    is_data = any(is_related(script, kind.cls, cls) for cls in classes)
    return None if is_data else Misfit("the data of an object", describe(kind))


def _array_misfit(  # noqa: PLR0911 - one return a reason
    script: Script, taker: Taker, node: ast.expr, sizes: tuple[int, ...]
) -> Misfit | None:
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
    if not changing and (size := size_of(script, node)) and size != sizes:
        return Misfit(takes, in_words(size), size[0])
    length = length_of(script, node)
    if not changing and length is not None and length != sizes[0] and not _has_own_words(script, node):
        return Misfit(takes, f"{length} items", length)
    if is_iterator(script, node):
        return Misfit(takes, "an iterator, which has no length")
    kind = script.type_of(node)
    if kind is None:
        return None
    length = 0 if changing else sizes[0] if len(sizes) == 1 else -1
    found = [_whole_misfit(script, node, member, length, takes) for member in members(kind)]
    return found[0] if all(found) else None


def _has_own_words(script: Script, node: ast.expr) -> bool:
    """Whether more is told of a value than how many items it has: of which class it is."""
    return script.class_of(node) in LENGTHS


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
    return Misfit(takes, f"an item that is {shown(script, node, describe(members(kind)[0]) or 'None')}")


def _whole_misfit(script: Script, node: ast.expr, kind: Type, length: int, takes: str) -> Misfit | None:
    """Why an array of a length refuses a value that is not written out; 0 is a length that changes, -1 an array of
    arrays.
    """
    if kind == NONE:
        return Misfit(takes, "None") if isinstance(written(script, node), ast.Constant) else None
    given = describe(kind)
    if isinstance(kind, Plain) and kind.kind in {"int", "float"}:
        text = shown(script, node, "")
        return Misfit(takes, f"the single number {text}" if text else given)
    if isinstance(kind, Mapping) or (isinstance(kind, Plain) and kind.kind != "bytes"):
        return Misfit(takes, shown(script, node, given))
    if isinstance(kind, Instance):
        has = LENGTHS.get(kind.cls, 0)
        if has and length and length != has:
            return Misfit(takes, f"{given}, which has {has}", has)
        if kind.sure and kind.cls.startswith(T) and not kind.cls.startswith("bpy.types.bpy_"):
            return Misfit(takes, given)
    return None


def _takes(taker: Taker) -> str:
    if taker.kind == "pointer":
        return f"an instance of `{taker.target}`"
    return "bytes" if taker.subtype == _BYTES else _WORDS[taker.kind]
