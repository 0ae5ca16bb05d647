"""Blender's API as types: what members are, and what calls return."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.flow.blender.classes import Classes
from kb_build.flow.blender.facts import (
    ELEMENT,
    ELEMENTS,
    LAYER_ITEM,
    LAYERS,
    LAYERS_OF,
    NARROWER,
    OF_OBJECT,
    OF_OPERATOR,
    OPERATOR_PROPERTIES,
    SAME_CLASS,
    SAME_TYPE,
)
from kb_build.flow.blender.literal_classes import LiteralClasses
from kb_build.flow.blender.type_text import read_type
from kb_build.flow.values.types import (
    BOOL,
    FLOAT,
    INT,
    STR,
    UNKNOWN,
    ClassObject,
    Collection,
    FromProperty,
    Function,
    Instance,
    Module,
    Operator,
    Plain,
    Sequence,
    Tuple,
    Type,
    Union,
    Unknown,
    members,
    union,
)
from kb_build.symbols.api_names import COLLECTION, GROUPS, ID, OBJECT, OPERATOR_METHODS, OPERATORS, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import ENUM_FLAG
from kb_build.symbols.math_classes import math_class
from kb_build.symbols.object_data import OBJECT_DATA, OF_EMPTIES, data_class
from kb_build.symbols.paths import argument_of, plain_path
from kb_build.symbols.python_values import is_new_list

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.blender.former_names import FormerNames
    from kb_build.flow.blender.symbols import Symbols
    from kb_build.symbols.records import Parameter, Symbol

ARRAY = "bpy.types.bpy_prop_array"
_DATA = f"{OBJECT}.data"
_ROOTS = {"bpy.data": f"{T}BlendData", "bpy.context": f"{T}Context"}
_SCALARS: dict[str, Type] = {"boolean": BOOL, "int": INT, "float": FLOAT, "string": STR}
MENU_SOCKET = f"{T}NodeSocketMenu"
_OF_CLASS = "_OT_"


def part_of_macro(parameter: Parameter) -> str:
    """The operator whose keywords a macro takes as a dictionary by one of its own; empty for other keywords."""
    return operator_path(parameter.type) if _OF_CLASS in parameter.type else ""


def operator_path(text: str) -> str:
    """The path of an operator that a text names: ``object.delete``, or ``OBJECT_OT_delete``."""
    module, of_class, name = text.partition(_OF_CLASS)
    if not of_class:
        module, _, name = text.partition(".")
    return f"{OPERATORS}{module.lower()}.{name}"  # Blender takes the module in capitals too


@dataclass(frozen=True, slots=True)
class Member:
    """A member as a class or module has it: its symbol, and the type of its value."""

    symbol: Symbol
    type: Type


class Api(Classes):
    """The types of one Blender's API. What is there is kept; names that are not would be without end.

    With ``former`` a name that is gone has the type of what took its place: what a script does with it can be judged.
    """

    def __init__(self, symbols: Symbols, former: FormerNames | None = None) -> None:
        super().__init__(symbols)
        self.literals = LiteralClasses(self, former)
        self._former = former
        self._sockets: dict[str, tuple[Symbol, ...]] = {}
        self._members: dict[tuple[str, str], Member] = {}
        self._below: dict[tuple[str, str], tuple[tuple[str, Member], ...]] = {}
        self._returns: dict[str, Type] = {}

    # Members.

    def member(self, cls: str, name: str) -> Member | None:
        """A member of a class, inherited ones included, or of a module."""
        key = cls, name
        found = self._members.get(key)
        if found is None:
            symbol = self.inherited(cls, name)
            if symbol is not None:
                found = self._members[key] = Member(symbol, self._type_of(symbol))
        return found

    def below(self, cls: str, name: str) -> tuple[tuple[str, Member], ...]:
        """The classes derived from ``cls`` that have a member which it lacks: (class, member)."""
        key = cls, name
        found = self._below.get(key)
        if found is None:
            rows: dict[str, tuple[str, Member]] = {}
            for child in self.descendants(cls):
                symbol = self.own_member(child, name)
                if symbol is not None and symbol.path not in rows:
                    rows[symbol.path] = child, Member(symbol, self._type_of(symbol))
            found = tuple(rows.values())
            if found:
                self._below[key] = found
        return found

    def below_as_data(self, name: str) -> tuple[tuple[str, Member], ...]:
        """The classes of objects' data, and those around them, that have a member: (class, member)."""

        def is_of_data(cls: str) -> bool:
            return any(self.descends(cls, each) or self.descends(each, cls) for each in self._object_data)

        return tuple((cls, member) for cls, member in self.below(ID, name) if is_of_data(cls))

    @cached_property
    def _object_data(self) -> tuple[str, ...]:
        """The classes of objects' data, and of what an empty shows."""
        names = (data_class(kind, lambda each: self.is_class(T + each)) for kind in OBJECT_DATA)
        return tuple(T + name for name in (*names, OF_EMPTIES))

    def had(self, cls: str, name: str) -> bool:
        """Whether a class had, or gets, a member in another Blender that it lacks in this one; "" has modules."""
        return self._former is not None and self._former.had(cls, name)

    def had_value(self, path: str, value: str) -> bool:
        """Whether a property had, or gets, a value in another Blender that it lacks in this one."""
        return self._former is not None and self._former.had_value(path, value)

    def successor_type(self, owner: str, name: str) -> Type:
        """The type of what took the place of a member that a class or module lacks; UNKNOWN if that is not sure."""
        path = self._former.successor(owner, name) if self._former else ""
        path = path or next(filter(None, (SAME_TYPE.get(f"{cls}.{name}") for cls in self.lineage(owner))), "")
        symbol = self.symbols.symbol(path) if path else None
        return self._type_of(symbol) if symbol else UNKNOWN

    def _type_of(self, symbol: Symbol) -> Type:  # noqa: PLR0911 - one return a kind
        path = symbol.path
        match symbol.kind:
            case "class":
                return ClassObject(path)
            case "module":
                return Module(path)
            case "operator":
                return Operator(path)
            case "function":
                return Function(path, UNKNOWN)
            case "enum":
                return UNKNOWN
            case _:
                pass
        if path in _ROOTS:
            return Instance(_ROOTS[path])
        if symbol.type == "collection":
            element = Instance(self._target(symbol))
            if is_new_list(symbol.kind, symbol.type):
                return Sequence("list", element)
            container = f"{T}{symbol.collection}" if symbol.collection else COLLECTION
            if not symbol.collection and self.descends(element.cls, f"{T}PropertyGroup"):
                container = GROUPS
            return Collection(element, container, path, UNKNOWN)
        if path == _DATA:
            return Instance(self._target(symbol), ((OF_OBJECT, Instance(OBJECT)),))
        if symbol.type == "pointer" or symbol.target:
            return Instance(self._target(symbol))
        return self._value_type(symbol)

    def _target(self, symbol: Symbol) -> str:
        narrower = T + NARROWER.get(symbol.path, "")
        return narrower if self.is_class(narrower) else f"{T}{symbol.target}"

    def instance(self, cls: str) -> Type:
        """An instance of a class; UNKNOWN if there is no such class."""
        return Instance(cls) if cls and self.is_class(cls) else UNKNOWN

    def _value_type(self, symbol: Symbol) -> Type:
        if symbol.type == "enum":
            value = Plain("str", None, FromProperty(symbol.path))
            return Sequence("set", value) if ENUM_FLAG in symbol.flags else value
        scalar = _SCALARS.get(symbol.type)
        if scalar is None:
            return self.read_type(symbol.type, symbol.path)
        if not symbol.array:
            return Plain("bytes") if symbol.subtype == "BYTE_STRING" else scalar
        if math := math_class(symbol):
            return Instance(math)
        size = symbol.array[-1]
        element: Type = scalar if len(symbol.array) == 1 else Instance(ARRAY, ((ELEMENT, scalar),))
        return Instance(ARRAY, ((ELEMENT, element),)) if size else Sequence("array", scalar)

    @staticmethod
    def keyword_type(path: str, parameter: Parameter) -> Type:
        """The type of what an operator is called with by a keyword; UNKNOWN for what has members or parts."""
        if parameter.type == "enum":
            return Plain("str", None, FromProperty(f"{path}({parameter.name})"))
        if part := part_of_macro(parameter):
            return Instance(OPERATOR_PROPERTIES, ((OF_OPERATOR, Operator(part)),))
        return _SCALARS.get(parameter.type, UNKNOWN)

    def read_type(self, text: str, scope: str) -> Type:
        """The type that a text spells, seen from a symbol."""
        return read_type(text, lambda name: self.class_named(name, scope)) if text else UNKNOWN

    def object_data(self, value: str) -> Type:
        """The data of an object of a type: ``MESH`` → Mesh."""
        return self.instance(T + data_class(value, lambda name: self.is_class(T + name)))

    # Calls.

    def returned(self, path: str, receiver: Type) -> Type:
        """What a function of the API returns when it was read from ``receiver``."""
        found = self._returns.get(path)
        if found is None:
            symbol = self.symbols.symbol(path)
            found = self._returns[path] = self._declared(symbol) if symbol else UNKNOWN
        return self.as_held_by(found, receiver, path.rpartition(".")[2])

    def as_held_by(self, kind: Type, receiver: Type, name: str) -> Type:
        """A member's type with what its receiver adds: the element of a collection, a copy's own class."""
        if isinstance(receiver, Collection):
            return self._of_collection(kind, receiver, name)
        if not isinstance(receiver, Instance):
            return kind
        if isinstance(kind, Union) and receiver.traits:
            return union(self.as_held_by(member, receiver, name) for member in kind.members)
        if isinstance(kind, Instance):
            if name in SAME_CLASS and self.descends(receiver.cls, kind.cls):
                return receiver
            if kind.cls == LAYER_ITEM and receiver.traits:
                return replace(kind, traits=receiver.traits)
            if kind.cls == LAYERS:
                kind = replace(kind, traits=(*kind.traits, (LAYERS_OF, receiver)))
        return kind

    def _of_collection(self, kind: Type, receiver: Collection, name: str) -> Type:
        match name:
            case "get" if isinstance(kind, Unknown) or kind == Instance(STRUCT) or len(members(kind)) > 1:
                return receiver.element
            case "add" if receiver.container == GROUPS:
                return receiver.element
            case "values":
                return Sequence("list", receiver.element)
            case "items":
                return Sequence("list", Tuple((STR, receiver.element)))
            case _:
                return kind

    def _declared(self, symbol: Symbol) -> Type:
        kinds = [self._returned_value(result, symbol) for result in symbol.returns]
        if not kinds:
            return UNKNOWN
        return kinds[0] if len(kinds) == 1 else Tuple(tuple(kinds))

    def _returned_value(self, result: Parameter, symbol: Symbol) -> Type:
        if result.type == "Self":
            return self.instance(symbol.owner)
        if result.type == "float[3]":
            return Instance("mathutils.Vector")
        if result.type == "float[4][4]":
            return Instance("mathutils.Matrix")
        if symbol.owner.endswith("bpy_prop_collection") and symbol.name == "get":
            return UNKNOWN
        return self.read_type(result.type, symbol.path)

    def sockets(self, cls: str, side: str) -> Iterator[Symbol]:
        """The sockets of a node's class on one side, ``inputs`` or ``outputs``."""
        found = self._sockets.get(cls)
        if found is None:
            found = self._sockets[cls] = tuple(
                symbol for owner in self.lineage(cls) for symbol in self.symbols.members(owner)
                if symbol.kind == "socket"
            )  # fmt: skip
        for symbol in found:
            if symbol.path.startswith(f"{symbol.owner}.{side}["):
                yield symbol

    def values_of(self, path: str) -> tuple[str, ...]:
        """The values of an enumeration, given by its property or by ``function(parameter)``."""
        symbol, argument = self.symbols.symbol(plain_path(path)), argument_of(path)
        found = symbol.parameter(argument) if symbol and argument else symbol
        return tuple(item.identifier for item in found.enum_items) if found else ()

    def socket_type(self, symbol: Symbol, *, fixed: bool = True) -> Type:
        """The type of a socket; UNKNOWN where a setting of its node chooses it.

        ``fixed``: a menu has the same items in every such node.
        """
        if symbol.type_settings:
            return UNKNOWN
        if fixed and symbol.type == "menu" and symbol.enum_items and self.is_class(MENU_SOCKET):
            return Instance(MENU_SOCKET, (("default_value", Plain("str", None, FromProperty(symbol.path))),))
        target = f"{T}{symbol.target}"
        if not self.descends(target, f"{T}NodeSocket"):
            target = f"{T}NodeSocket{symbol.type.title()}"
        return self.instance(target)

    def element(self, kind: Instance) -> Type:
        """What an instance holds, when it is indexed or looped over."""
        if held := kind.trait(ELEMENT):
            return replace(kind, cls=LAYER_ITEM) if kind.cls == LAYERS else held
        if names := ELEMENTS.get(kind.cls):
            return union(Instance(name) for name in names)
        return UNKNOWN

    def is_operator_method(self, name: str) -> bool:
        """Whether every operator of ``bpy.ops`` has an attribute of this name."""
        return name in OPERATOR_METHODS
