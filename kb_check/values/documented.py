"""What refuses a value of which only the reference tells what it takes: functions and members that are not RNA's.

Those written in C take instances of just the class that they name. The operators of bmesh convert nothing: their
elements come in a list, a tuple or one of bmesh's own sequences, and a set, a generator or a single one is refused.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import ELEMENT, ELEMENTS, LAYER_ITEM
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Instance,
    Mapping,
    Plain,
    Sequence,
    Tuple,
    members,
    without_none,
)
from kb_build.symbols.api_names import STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.paths import last_name
from kb_check.calls.sites import calls_by_node
from kb_check.syntax.bindings import bindings, once_bound
from kb_check.syntax.literals import items, written
from kb_check.values.misfits import Misfit, describe, shown

if TYPE_CHECKING:
    from kb_build.flow.values.types import Type
    from kb_check.script import Script
    from kb_check.values.given import Taker

_ELEMENTS = ("BMVert", "BMEdge", "BMFace")
_EXTRUDING, _FACE = "bmesh.ops.extrude_face_region", "bmesh.types.BMFace"
# How many numbers a class always has.
LENGTHS = {"mathutils.Color": 3, "mathutils.Euler": 3, "mathutils.Quaternion": 4}
_AXIS = 3  # numbers that a quaternion is made of besides its own four
_VECTOR = re.compile(r"tuple\[(float(?:, float)+)\] \| Sequence\[float\]|float\[(\d)\]")
_SIZE = re.compile(r"\b([234])D\b")  # of the vector that a member of bmesh's classes is
_BMESH, _BMESH_OPERATORS, _BMESH_TYPES = "bmesh.", "bmesh.ops.", "bmesh.types."
_MATHUTILS, _MATRIX, _VECTOR_CLASS = "mathutils.", "mathutils.Matrix", "mathutils.Vector"
# ``bpy.types.Mesh``, ``Sequence[BMVert | BMEdge]``, ``bpy.types.Area | None``.
_CLASSES = re.compile(r"(?P<many>Sequence\[)?(?P<classes>[\w.]+(?: \| [\w.]+)*)(?(many)\])")
_WORD = re.compile(r"\w+")
_CLASS = re.compile(r"type(\[.*\])?")  # of what takes a class itself
_DECLARING = "bpy.props."  # has a rule of its own
_IN_C = ("bmesh.", "mathutils.", "gpu.", "imbuf.", T)
# Where a number or a text is one: functions in C.
_CONVERT_NOTHING = (
    "aud.", "bl_math.", "blf.", "bmesh.", f"{STRUCT}.", "bpy.utils.units.", "gpu.", "imbuf.", "mathutils.",
)  # fmt: skip
_ANYTHING = frozenset({f"{T}AnyType", f"{T}Property", f"{T}Struct"})
_NUMBERS = frozenset({"bool", "int", "float"})
_OF_LAYERS = {"color": 4, "float_color": 4, "float_vector": 3, "shape": 3}  # numbers of each element
_TRUTH = frozenset({"bool", "int"})
# Documented types that surely refuse others: what each takes. ``bool`` takes anything, as Python does.
_DOCUMENTED = {"str": frozenset({"str"}), "string": frozenset({"str"}), "float": _NUMBERS, "int": _NUMBERS}
# The operators of bmesh, and the members of its classes, convert nothing: each was given the others.
_STRICT = {**_DOCUMENTED, "enum": frozenset({"str"}), "int": _TRUTH, "bool": _TRUTH}
_WORDS = {"int": "an int", "bool": "True or False"}
# The parts of documented types of mathutils that are sequences of numbers.
_OF_MATHUTILS = frozenset({"Vector", "Quaternion", "Euler", "Matrix", "Color", "Sequence[float]", "None"})
# What rotates a value is an instance of one of these, and no sequence.
_ROTATIONS = frozenset({"Euler", "Quaternion", "Matrix"})


def lengths(taker: Taker) -> tuple[int, ...]:
    """How many numbers is taken whose sequence no array of RNA's tells; none where any number may be right.

    It is the first of what makes one of mathutils' values, or one of bmesh's.
    """
    symbol = taker.symbol
    if symbol.kind == "class" and symbol.path in LENGTHS:
        is_first = taker.path == f"{symbol.path}({symbol.parameters[0].name})"
        return tuple(sorted({_AXIS, LENGTHS[symbol.path]})) if is_first else ()
    if not taker.path.startswith(_BMESH):
        return ()
    if found := _VECTOR.fullmatch(taker.documented):
        return (int(found[2]) if found[2] else found[1].count("float"),)
    size = _SIZE.search(symbol.description) if _is_vector_member(taker) else None
    return (int(size[1]),) if size else ()


def length_misfit(script: Script, node: ast.expr, taken: tuple[int, ...]) -> Misfit | None:
    """Why a sequence of another length is refused."""
    takes = f"{' or '.join(map(str, taken))} numbers"
    if (parts := items(script, node)) is not None:
        return None if len(parts) in taken else Misfit(takes, f"{len(parts)} items", len(parts))
    kind = script.type_of(node)
    has = LENGTHS.get(kind.cls, 0) if isinstance(kind, Instance) and kind.sure else 0
    return (
        Misfit(takes, f"{describe(kind)}, which has {has}", has)
        if kind and has and has not in taken
        else None
    )


def documented_misfit(script: Script, taker: Taker, node: ast.expr, kind: Type) -> Misfit | None:
    """Why the reference says that a value of a type is refused; None where it may be taken."""
    return _plain_misfit(taker, kind) or _class_misfit(script, taker, node, kind)


def none_misfit(script: Script, taker: Taker) -> Misfit | None:
    """Why None is refused, of what is no RNA; None where it may be taken."""
    if taker.path.startswith(_MATHUTILS) and not taker.is_parameter and taker.documented == "float":
        return Misfit("a number", "None")
    classes, is_many = _classes(script, taker)
    if not taker.path.startswith(_BMESH_OPERATORS) or not classes:
        return None
    return Misfit(_takes(classes, is_many), "None")


def _is_vector_member(taker: Taker) -> bool:
    is_member = not taker.is_parameter and taker.path.startswith(_BMESH_TYPES)
    return is_member and taker.documented == _VECTOR_CLASS


def _rotations_only(documented: str) -> bool:
    return frozenset[str](_WORD.findall(documented)) - {"or"} == _ROTATIONS


def _plain_misfit(taker: Taker, kind: Type) -> Misfit | None:
    """A value that no reading of the reference allows: text for a number, a number for text, either for a vector."""
    path, documented = taker.path, taker.documented
    if path.startswith(_MATHUTILS) and _rotations_only(documented):
        is_refused = isinstance(kind, (Plain, Tuple, Sequence))
        if isinstance(kind, Instance) and kind.sure and kind.cls.startswith((_MATHUTILS, ARRAY)):
            is_refused = last_name(kind.cls) not in _ROTATIONS
        return Misfit("an Euler, a Quaternion or a Matrix", describe(kind)) if is_refused else None
    is_math = path.startswith(_MATHUTILS) and _OF_MATHUTILS.issuperset(_parts(documented))
    is_vector = path.startswith(_BMESH_OPERATORS) and _VECTOR.fullmatch(documented)
    if is_math or is_vector or _is_vector_member(taker):
        is_refused = isinstance(kind, Plain) and kind.kind != "bytes"
        return Misfit("a sequence of numbers", describe(kind)) if is_refused else None
    if taker.is_parameter and _CLASS.fullmatch(documented) and not path.startswith(_DECLARING):
        is_refused = isinstance(kind, (Plain, Tuple, Sequence, Mapping))
        return Misfit("a class", describe(kind)) if is_refused else None
    is_member = not taker.is_parameter and path.startswith(_BMESH_TYPES)
    strict = _STRICT if is_member or path.startswith(_BMESH_OPERATORS) else _DOCUMENTED
    fits = strict.get(documented)
    if documented.startswith("dict["):
        return Misfit("a dict", describe(kind)) if isinstance(kind, (Plain, Tuple, Sequence)) else None
    if fits is None or not _is_no_such(kind, fits, path):
        return None
    takes = _WORDS.get(documented, "") if strict is _STRICT else ""
    return Misfit(takes or ("a str" if "str" in fits else "a number"), describe(kind))


def _is_no_such(kind: Type, fits: frozenset[str], path: str) -> bool:
    """Whether a value surely is no number, or text, of some kinds: it is of another kind, or holds several of any."""
    if isinstance(kind, Plain):
        return kind.kind not in fits
    is_math = isinstance(kind, Instance) and kind.sure and kind.cls.startswith(_MATHUTILS)
    return path.startswith(_CONVERT_NOTHING) and (is_math or isinstance(kind, (Tuple, Sequence, Mapping)))


def _class_misfit(script: Script, taker: Taker, node: ast.expr, kind: Type) -> Misfit | None:
    """A value that is refused where instances of classes are taken, or a sequence of them."""
    classes, is_many = _classes(script, taker)
    if not classes:
        return None
    takes = _takes(classes, is_many)
    if not taker.path.startswith(_IN_C):  # Python takes whatever has the same members
        is_refused = isinstance(kind, Instance) and kind.cls.startswith(T) and not is_many
        return Misfit(takes, describe(kind)) if is_refused and _is_none_of(script, kind, classes) else None
    if not is_many:
        return Misfit(takes, describe(kind)) if _is_none_of(script, kind, classes) else None
    is_operator = taker.path.startswith(_BMESH_OPERATORS)
    is_one = isinstance(kind, Instance) and any(script.api.descends(kind.cls, cls) for cls in classes)
    if isinstance(kind, Plain) or is_one or (is_operator and _is_unlisted(script, node, kind)):
        return Misfit(takes, describe(kind))
    given = _wrong_items(script, node, kind, classes)
    return Misfit(takes, given) if given else None


def _wrong_items(script: Script, node: ast.expr, kind: Type, classes: tuple[str, ...]) -> str:
    """What is wrong with the items of a sequence of instances of classes; empty if nothing surely is."""
    for part in items(script, node) or ():
        of = script.type_of(part)
        if of is not None and _is_none_of(script, of, classes):
            return f"an item that is {shown(script, part, describe(of))}"
    if _is_extruded(script, node) and len(classes) < len(_ELEMENTS):
        return "all that was extruded, edges and faces as well: choose with `isinstance`"
    if isinstance(kind, Tuple) and any(_is_none_of(script, one, classes) for one in kind.items):
        return _holding(kind.items)
    element = _element(kind)
    is_wrong = element is not UNKNOWN and all(_is_none_of(script, one, classes) for one in members(element))
    return _holding(members(element)) if is_wrong else ""


def _holding(kinds: tuple[Type, ...]) -> str:
    return f"a sequence that holds {' and '.join(dict.fromkeys(map(describe, kinds)))}"


def _is_extruded(script: Script, node: ast.expr) -> bool:
    """Whether a value is what extruding faces gave, whole: vertices, edges and faces in one list."""
    match once_bound(script, node):
        case ast.Subscript(value=result, slice=ast.Constant(value="geom")):
            made = once_bound(script, result)
        case _:
            return False
    call = calls_by_node(script).get(made) if isinstance(made, ast.Call) else None
    given = call.argument("geom") if call and call.callee.symbol.path == _EXTRUDING else None
    kind = script.type_of(given) if given else None
    return kind is not None and _element(kind) == Instance(_FACE)


def _takes(classes: tuple[str, ...], is_many: bool) -> str:
    named = " or ".join(f"`{cls}`" for cls in classes)
    return f"a list, tuple or sequence of instances of {named}" if is_many else f"an instance of {named}"


def _classes(script: Script, taker: Taker) -> tuple[tuple[str, ...], bool]:
    """The classes whose instances a parameter takes, by the reference, and whether it takes a sequence of them."""
    found = _CLASSES.fullmatch(taker.documented.removesuffix(" | None")) if taker.is_parameter else None
    if found is None:
        return (), False
    paths = tuple(
        script.api.class_named(name, f"{taker.symbol.path}.") for name in found["classes"].split(" | ")
    )
    # A vector may be any sequence of numbers; a matrix of an operator of bmesh's may not.
    is_open = any(
        not path or path in _ANYTHING or (path.startswith(_MATHUTILS) and not _is_exact(taker, path))
        for path in paths
    )
    return ((), False) if is_open else (paths, bool(found["many"]))


def _is_exact(taker: Taker, path: str) -> bool:
    is_tree = path.count(".") > 1  # of the modules in mathutils
    return is_tree or (path == _MATRIX and taker.path.startswith(_BMESH_OPERATORS))


def _is_none_of(script: Script, kind: Type, classes: tuple[str, ...]) -> bool:
    """Whether a value surely is no instance of some classes."""
    if isinstance(kind, Instance):
        known = kind.sure and script.api.is_class(kind.cls)
        return known and not any(is_related(script, kind.cls, cls) for cls in classes)
    return isinstance(kind, (Plain, Tuple, Sequence, Mapping))


def is_related(script: Script, cls: str, other: str) -> bool:
    """Whether something of a class may be of another one."""
    return script.api.descends(cls, other) or script.api.descends(other, cls)


def _is_unlisted(script: Script, node: ast.expr, kind: Type) -> bool:
    """Whether a value holds others in a way that the operators of bmesh do not take.

    What a function's annotation calls an iterable may be a list.
    """
    if isinstance(kind, Mapping) or (isinstance(kind, Sequence) and kind.kind == "set"):
        return True
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else [node]
    return bool(values) and all(isinstance(value, ast.GeneratorExp) for value in values)


def _element(kind: Type) -> Type:
    """What a sequence holds; UNKNOWN for what is none, or is written out."""
    match kind:
        case Sequence(element=element):
            return element
        case Instance(cls=cls) if cls in ELEMENTS and len(ELEMENTS[cls]) == 1:
            return Instance(ELEMENTS[cls][0])
        case _:
            return UNKNOWN


def _parts(documented: str) -> list[str]:
    return documented.replace(_MATHUTILS, "").split(" | ")


def _numbers_of_layer(script: Script, layer: ast.expr) -> int:
    """How many numbers a layer of vectors holds for each element; 0 where that is not known."""
    match once_bound(script, layer):
        case (
            ast.Call(func=ast.Attribute(value=ast.Attribute(attr=kind)))
            | ast.Attribute(value=ast.Attribute(attr=kind))
        ):
            return _OF_LAYERS.get(kind, 0)
        case _:
            return 0


def layer_misfit(script: Script, target: ast.Subscript, value: ast.expr) -> Misfit | None:
    """Why an element of a BMesh refuses a value for one of its layers: ``loop[uv_layer] = (0, 0)``."""
    owner, key, kind = map(script.type_of, (target.value, target.slice, value))
    layer = without_none(key or UNKNOWN)  # the active one may be none; as a key it is one
    is_element = isinstance(owner, Instance) and owner.sure and owner.cls.startswith(f"{_BMESH_TYPES}BM")
    if not is_element or not isinstance(layer, Instance) or layer.cls != LAYER_ITEM or not layer.sure:
        return None
    held = layer.trait(ELEMENT)
    is_none = isinstance(written(script, value), ast.Constant) and kind == NONE
    if held is None or kind is None or kind is UNKNOWN or (kind == NONE and not is_none):
        return None
    kinds = members(kind)
    match held:
        case Instance(cls=cls) if cls == _VECTOR_CLASS:
            wanted, parts = _numbers_of_layer(script, target.slice), items(script, value)
            if wanted and parts is not None and len(parts) != wanted:
                return Misfit(f"{wanted} numbers", f"{len(parts)} items", len(parts))
            is_refused = is_none or all(isinstance(one, (Plain, Mapping)) for one in kinds)
            takes = "a sequence of numbers"
        case Instance(cls=cls):
            is_refused = is_none or all(_is_none_of(script, one, (cls,)) for one in kinds)
            takes = f"an instance of `{cls}`"
        case Plain(kind=held_kind):
            fits = {"float": _NUMBERS, "int": _TRUTH, "bool": _TRUTH}.get(held_kind, frozenset({held_kind}))
            others = (Tuple, Sequence, Mapping)
            is_refused = is_none or all(
                isinstance(one, others) or (isinstance(one, Plain) and one.kind not in fits) for one in kinds
            )
            takes = describe(held)
        case _:
            return None
    return (
        Misfit(takes, "None" if is_none else shown(script, value, describe(kinds[0]))) if is_refused else None
    )
