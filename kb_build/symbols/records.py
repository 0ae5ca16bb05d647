"""The records of Blender's API: its symbols, what is kept of them, and how they are written as JSON.

Everything the extractor produces, and everything the server answers from, is one of these or a page. It imports
nothing of the project but leaves.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast

from kb_build.symbols.flag_names import (
    ALSO_NAMED,
    DEFINED,
    DEFINED_ALWAYS,
    IDENTIFIER,
    NEVER_BY_IDENTIFIER,
    PROVIDED_BY,
    SAME_AS,
    TYPE_BY,
    told_by,
)
from kb_build.symbols.needs import OperatorNeeds
from kb_build.symbols.paths import last_name, socket_name, socket_side
from kb_build.symbols.taken import NEVER, Taken
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Scalar = str | int | float | bool | None
Default = Scalar | list[Any]

SymbolKind = Literal[
    "module", "class", "property", "function", "operator", "socket", "data", "context", "enum"
]
LinkKind = Literal["manual", "base", "pointer", "collection", "socket-of"]


# The types of properties in Blender's own data: those of values, and all. What Python computes has others.
SCALAR_TYPES = frozenset({"boolean", "int", "float", "string", "enum"})
RNA_TYPES = SCALAR_TYPES | {"pointer", "collection"}
# How the types of parameters end that are texts for which None can be given, too.
OR_NONE = " or None"
# The functions that every class has from the base of all.
CLASS_LOOKUPS = ("bl_rna_get_subclass", "bl_rna_get_subclass_py")
# How the names begin of what is there when Blender starts, among those of new things.
STARTUP = "start-up "
FACTORY = "factory "


@value_class
class EnumItem:
    """One value of an enumeration.

    ``where`` it is taken; None for everywhere.
    """

    identifier: str
    name: str = ""
    description: str = ""
    where: Taken | None = None

    @property
    def is_taken(self) -> bool:
        """Whether anything takes it: RNA lists some that everything refused which was tried."""
        return self.where != NEVER


@value_class
class NewValue:
    """What newly made instances have: all of them, or those that ``made`` names, or those in the mode ``when``.

    Of several without a mode the first is the usual one; ``made`` is then empty: all the others. ``by`` is the call
    that made all that have it, if one call did. The last ones may be of what is there when Blender starts
    (``is_startup``), which is the usual one only where nothing of the kind can be made.
    """

    value: Default
    made: tuple[str, ...] = ()
    when: str = ""
    by: str = ""

    @property
    def is_startup(self) -> bool:
        """Whether it is not of a new thing, but of one that Blender starts with."""
        return (
            bool(self.made)
            and not self.when
            and all(name.startswith((STARTUP, FACTORY)) for name in self.made)
        )


@value_class
class Parameter:
    """One argument (or returned value) of a function or an operator.

    ``type`` is text for people (``"float[3]"``, ``"enum"``, ``"Object"``, ``"string or None"``); ``default`` is absent
    (None with ``required``) when the caller must give the argument. ``values_asked`` are those that Blender named in a
    new file, of an enumeration that it lists none of, or a stand-in: other files may have more.
    """

    name: str
    type: str = ""
    description: str = ""
    default: Default = None
    required: bool = False
    enum_items: tuple[EnumItem, ...] = ()
    label: str = ""
    hard_min: float | None = None
    hard_max: float | None = None
    unit: str = ""
    values_asked: tuple[str, ...] = ()

    @property
    def plain_type(self) -> str:
        """The type without whether None can be given, too."""
        return self.type.removesuffix(OR_NONE)

    @property
    def takes_none(self) -> bool:
        """Whether None can be given for a text."""
        return self.type.endswith(OR_NONE)

    @property
    def is_open(self) -> bool:
        """Whether the values depend on the instance: one that was not asked may take others."""
        return any(item.where for item in self.enum_items)

    @property
    def has_stand_in(self) -> bool:
        """Whether RNA lists nothing but what is refused, since the values are put together while Blender runs."""
        return bool(self.enum_items) and not any(item.is_taken for item in self.enum_items)


@value_class
class Deprecation:
    """What Blender itself, or its release notes, say of a property that is on its way out. Versions as ``"5.0"``."""

    note: str
    since: str = ""
    removal: str = ""


@value_class
class Refusal:
    """What Blender said to calls of a function whose arguments are those that the signature asks for.

    ``message`` has … for what things are called and what was given; it is empty where the call returned None. Refused
    were these ``values`` of the ``argument``, () for all; made of what ``by`` names, () for everything that was tried,
    while ``taken_by`` names what takes them. ``given`` are the further arguments with which they were taken, ``mode``
    the mode of the object. ``again``: only a call after another one was refused, ``any`` with its choice,
    the ``same`` one, or one with an ``other`` choice, too.
    """

    message: str
    argument: str = ""
    values: tuple[str, ...] = ()
    by: tuple[str, ...] = ()
    taken_by: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    mode: str = ""
    again: str = ""

    @property
    def is_explained(self) -> bool:
        """Whether it is known when the call is refused."""
        return bool(self.values or self.by or self.given or self.mode or self.again)


@value_class
class Symbol:
    """One public identifier of Blender's Python API.

    ``path`` is the identifier as the API reference writes it; what the reference lacks (node sockets) follows
    Python's own spelling: ``bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]``.
    Ranges are in the unit that ``unit`` names (Blender's scene units: metres, radians, frames).

    ``target`` is the class that a pointer, a collection or a socket leads to (an operator: its ``_OT_`` class),
    ``collection`` the class of the collection itself, which carries ``new`` and ``remove``; ``group`` of a class
    is ``data``, ``ui`` or ``operator``; ``modes`` name the enum values under which a node shows a socket;
    ``trees`` the node trees that take a node; ``reached`` is an expression that leads to an instance,
    ``lacks`` the property on that way which is None, or empty, on new things.

    ``default`` is RNA's, which a new instance need not have: ``new_values`` are what new ones had where some differed.
    The flag ``compared`` says that new ones were read. ``subscripts`` give a socket in every mode in which its node
    has it, best first; with the flag ``name-when-shown`` its name does only while the node shows it. So it is with
    ``identifier-when-shown`` of its identifier, which with ``identifier-never`` gives it in none of its node's modes.

    A pointer that is None on new things has None as its new value; a flag ``filled-by:CALL`` then names what was seen
    to fill it, flags ``filled-on:THING`` the new things on which it leads to something. ``needs`` are what an operator
    runs with, of all that was tried, beside an area if it wants one; None where it has no more to want, or that is not
    known. ``refusals`` are what a function refused, of all that was tried.
    """

    path: str
    kind: SymbolKind
    owner: str = ""
    label: str = ""
    description: str = ""
    type: str = ""
    subtype: str = ""
    unit: str = ""
    target: str = ""
    array: tuple[int, ...] = ()
    default: Default = None
    hard_min: float | None = None
    hard_max: float | None = None
    soft_min: float | None = None
    soft_max: float | None = None
    flags: tuple[str, ...] = ()
    enum_items: tuple[EnumItem, ...] = ()
    enum_computed: bool = False
    base: str = ""
    group: str = ""
    signature: str = ""
    parameters: tuple[Parameter, ...] = ()
    returns: tuple[Parameter, ...] = ()
    deprecation: Deprecation | None = None
    modes: tuple[str, ...] = ()
    collection: str = ""
    trees: tuple[str, ...] = ()
    reached: str = ""
    lacks: str = ""
    new_values: tuple[NewValue, ...] = ()
    subscripts: tuple[str, ...] = ()
    refusals: tuple[Refusal, ...] = ()
    needs: OperatorNeeds | None = None

    @property
    def name(self) -> str:
        """The last part of the path: what a programmer writes after the dot (or between the brackets)."""
        return socket_name(self.path) if self.kind == "socket" else last_name(self.path)

    @property
    def is_of_interface(self) -> bool:
        """Whether it is a class of the interface, or an operator's, and not of data."""
        return self.group in {"ui", "operator"}

    @property
    def is_class_lookup(self) -> bool:
        """Whether it looks up a class below its own: the reference lists these functions on every class."""
        return self.name in CLASS_LOOKUPS

    @property
    def side(self) -> str:
        """``inputs`` or ``outputs``, of a socket; "" for others."""
        return socket_side(self.path)

    @property
    def positional(self) -> list[Parameter]:
        """What calls give by place: all parameters but what a method is read from."""
        return [parameter for parameter in self.parameters if parameter.name not in {"self", "cls"}]

    def parameter(self, name: str) -> Parameter | None:
        """The parameter of a name."""
        return next((parameter for parameter in self.parameters if parameter.name == name), None)

    @property
    def has_empty_signature(self) -> bool:
        """Whether it is known to take no arguments, and is not one whose arguments are unknown."""
        return self.signature == f"{self.name}()"

    @property
    def socket_names(self) -> tuple[str, ...]:
        """The names that a socket has in the modes of its node, the usual one first."""
        return (self.label, *self.flagged(ALSO_NAMED))

    @property
    def identifier(self) -> str:
        """A socket's identifier, which its name need not be; empty for what is no socket."""
        return "".join(self.flagged(IDENTIFIER)[:1])

    @property
    def socket_keys(self) -> tuple[str, ...]:
        """The texts in brackets that give a socket, at least in some modes of its node: its names, and its identifier
        where that does, too.
        """
        by_identifier = self.identifier and NEVER_BY_IDENTIFIER not in self.flags
        names = (*self.socket_names, self.identifier) if by_identifier else self.socket_names
        return tuple(dict.fromkeys(name for name in names if name))

    @property
    def type_settings(self) -> tuple[str, ...]:
        """The settings of its node that choose a socket's type; none where it is always the same."""
        return self.flagged(TYPE_BY)

    @property
    def is_called_back(self) -> bool:
        """Whether classes of scripts define the function, and Blender calls it."""
        return not {DEFINED, DEFINED_ALWAYS}.isdisjoint(self.flags)

    @property
    def same_as(self) -> str:
        """The path of what it repeats, or is another name of; empty for none."""
        return next(iter(self.flagged(SAME_AS)), "")

    @property
    def editors(self) -> tuple[str, ...]:
        """The kinds of editors that provide a member of the context; ``screen`` stands for all."""
        return self.flagged(PROVIDED_BY)

    def flagged(self, prefix: str) -> tuple[str, ...]:
        """What the flags that begin with ``prefix`` say."""
        return told_by(self.flags, prefix) if self.flags else ()


# What a setting is where what it depends on is otherwise: Blender's panels grey it out, or do not show it; or it has no
# effect, as it was tried.
Otherwise = Literal["greyed", "hidden", "idle"]


class SettingCondition(NamedTuple):
    """What a setting (``gate``) must be, as text: ``on``, ``'SUN'``, before Blender's panels let ``path`` be set, or an
    operator be run; or before it has an effect.

    Of those with one ``clause`` any is enough; all clauses must hold.
    """

    path: str
    clause: int
    gate: str
    test: str
    otherwise: Otherwise


@value_class
class Link:
    """A relation between two ids (symbol paths or page slugs)."""

    source: str
    target: str
    kind: LinkKind


_LEAVES = frozenset({str, int, float, bool, type(None)})


def to_json(symbol: Symbol) -> dict[str, Any]:
    """A symbol as a JSON-ready dictionary, without the fields that hold their default value."""
    return {
        name: _plain(value)
        for name, default in _fields(Symbol)
        if (value := getattr(symbol, name)) != default
    }


def _plain(value: Any) -> Any:
    """A field's value, the records in it taken apart."""
    if type(value) in _LEAVES:  # hundreds of thousands
        return value
    if isinstance(value, tuple):
        return [_plain(part) for part in cast("tuple[Any, ...]", value)]
    known = _fields(type(value))
    return {name: _plain(getattr(value, name)) for name, _ in known} if known else value


@cache
def _fields(of: type) -> tuple[tuple[str, Any], ...]:
    """(name, default) of the fields of a record; none for other values."""
    return tuple((field.name, field.default) for field in fields(of)) if is_dataclass(of) else ()


def _enum_item(row: dict[str, Any]) -> EnumItem:
    if row.get("where") is None:
        return EnumItem(**row)
    values: dict[str, Any] = {**row, "where": Taken.of(row["where"])}
    return EnumItem(**values)


def _enum_items(rows: list[dict[str, Any]]) -> tuple[EnumItem, ...]:
    return tuple(map(_enum_item, rows))


def _parameters(rows: list[dict[str, Any]]) -> tuple[Parameter, ...]:
    parameters: list[Parameter] = []
    for row in rows:
        values: dict[str, Any] = {
            **row,
            "enum_items": _enum_items(row.get("enum_items", [])),
            "values_asked": tuple(row.get("values_asked", ())),
        }
        parameters.append(Parameter(**values))
    return tuple(parameters)


def _new_values(rows: list[dict[str, Any]]) -> tuple[NewValue, ...]:
    return tuple(
        NewValue(row["value"], tuple(row.get("made", ())), row.get("when", ""), row.get("by", ""))
        for row in rows
    )


def _refusals(rows: list[dict[str, Any]]) -> tuple[Refusal, ...]:
    refusals: list[Refusal] = []
    for row in rows:
        values: dict[str, Any] = {
            name: tuple(row.get(name, ())) for name in ("values", "by", "taken_by", "given")
        }
        refusals.append(Refusal(**{**row, **values}))
    return tuple(refusals)


# How the fields that JSON has as lists or objects are read.
_SYMBOL_FIELDS: dict[str, Callable[[Any], Any]] = {
    **dict.fromkeys(("array", "flags", "modes", "trees", "subscripts"), tuple),
    "enum_items": _enum_items,
    "parameters": _parameters,
    "returns": _parameters,
    "deprecation": lambda row: Deprecation(**row),
    "new_values": _new_values,
    "refusals": _refusals,
    "needs": OperatorNeeds.of,
}


def symbol_fields(data: Mapping[str, Any]) -> dict[str, Any]:
    """A symbol's fields as JSON has them, as those of a Symbol; unknown ones as they are."""
    return {
        name: _SYMBOL_FIELDS[name](value) if name in _SYMBOL_FIELDS else value for name, value in data.items()
    }


def symbol_from_json(data: Mapping[str, Any]) -> Symbol:
    """The inverse of :func:`to_json`. Raises TypeError on unknown fields."""
    return Symbol(**symbol_fields(data))
