"""What an expression can be: the types that flow through a script.

Types are immutable and compare by value. ``None`` as a Python value is :data:`NONE`; what is not known is
:data:`UNKNOWN`. A type whose ``sure`` is False rests on a convention (a parameter called ``context``), not on code.
"""

from __future__ import annotations

import builtins
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeGuard

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterable, Iterator

MOST_MEMBERS = 8  # of a union; more are UNKNOWN


@dataclass(frozen=True, slots=True)
class Unknown:
    """Anything."""


@dataclass(frozen=True, slots=True)
class NoneValue:
    """Python's None."""


@dataclass(frozen=True, slots=True)
class FromProperty:
    """It was read from a property or a parameter, given by its path, which knows its values."""

    path: str


@dataclass(frozen=True, slots=True)
class FromVersion:
    """It tells of this very Blender: by its version, or by what that decides."""


@dataclass(frozen=True, slots=True)
class FromNames:
    """It tells of this very Blender: whether it has names that were asked for."""

    names: frozenset[str]


@dataclass(frozen=True, slots=True)
class Passed:
    """It is a text that some call passes, and others may not."""


Telling = FromVersion | FromNames
Source = FromProperty | Telling | Passed


@dataclass(frozen=True, slots=True)
class Plain:
    """A number, a text, a truth value. ``value`` is the literal where it is known, else None.

    ``source`` is where it comes from, where that matters.
    """

    kind: str
    value: str | int | float | bool | None = None
    source: Source | None = None


@dataclass(frozen=True, slots=True)
class Instance:
    """An instance of one of the API's classes, given by its path.

    ``traits`` are members about which more is known than the class tells: ``("data", Instance(Mesh))``.
    """

    cls: str
    traits: tuple[tuple[str, Type], ...] = ()
    sure: bool = True

    def trait(self, name: str) -> Type | None:
        """What is known of a member of this very instance."""
        for known, kind in self.traits:
            if known == name:
                return kind
        return None


@dataclass(frozen=True, slots=True)
class ClassObject:
    """One of the API's classes itself."""

    cls: str


@dataclass(frozen=True, slots=True)
class Module:
    """A module of the API."""

    path: str


@dataclass(frozen=True, slots=True)
class LocalModule:
    """A module or package of the files that are analysed together, by its dotted name."""

    name: str


@dataclass(frozen=True, slots=True)
class Function:
    """A function or method of the API, read from ``receiver``."""

    path: str
    receiver: Type


@dataclass(frozen=True, slots=True)
class Operator:
    """An operator, ready to be called."""

    path: str


@dataclass(frozen=True, slots=True)
class Collection:
    """A collection of RNA. ``container`` is the class of the collection itself, ``path`` the property that it was
    read from, ``owner`` what that was read from.
    """

    element: Type
    container: str
    path: str
    owner: Type


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list, tuple, set or iterator whose elements are all of one type; ``is_empty`` while it surely has none."""

    kind: str
    element: Type
    is_empty: bool = False


@dataclass(frozen=True, slots=True)
class Tuple:
    """A tuple or list whose items are known one by one."""

    items: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Mapping:
    """A dictionary; ``items`` are what is known of its literal keys. ``is_empty`` while it surely has none."""

    key: Type
    value: Type
    items: tuple[tuple[str, Type], ...] = ()
    is_empty: bool = False


@dataclass(frozen=True, slots=True)
class LocalFunction:
    """A function of the script; ``number`` finds its definition. ``receiver`` is what a method is bound to."""

    number: int
    receiver: Type | None = None


@dataclass(frozen=True, slots=True)
class LocalClass:
    """A class of the script."""

    number: int


@dataclass(frozen=True, slots=True)
class LocalInstance:
    """An instance of one of the script's classes."""

    number: int


@dataclass(frozen=True, slots=True)
class Builtin:
    """One of Python's own functions, or a method of a plain value; ``receiver`` is what it was read from."""

    name: str
    receiver: Type | None = None


@dataclass(frozen=True, slots=True)
class Union:
    """One of several types."""

    members: tuple[Type, ...]


Type = (
    Unknown
    | NoneValue
    | Plain
    | Instance
    | ClassObject
    | Module
    | Function
    | Operator
    | Collection
    | Sequence
    | Tuple
    | Mapping
    | LocalModule
    | LocalFunction
    | LocalClass
    | LocalInstance
    | Builtin
    | Union
)

_HOLDERS = (Sequence, Tuple, Mapping)
# What one call passes: parameter → type, of all that have one.
Given = tuple[tuple[str, Type], ...]
# What was known of other definitions when they were read: (class, attribute), or of a function what it returns: "" to
# any call, or what one call passes.
Readings = dict[tuple[int, str | Given], Type | None]
# (function, what is passed, where) of the calls that surely happen where what they are in is run, in their order.
Uses = dict[tuple[int, Given, "ast.Call"], None]
# (where, text) → what a text that comes from elsewhere is found to be there.
Carried = dict[tuple["ast.AST", str], "Resolution"]

FROM_VERSION = FromVersion()
PASSED = Passed()
UNKNOWN = Unknown()
NONE = NoneValue()
BOOL = Plain("bool")
INT = Plain("int")
FLOAT = Plain("float")
STR = Plain("str")


def members(kind: Type) -> tuple[Type, ...]:
    """The members of a union; any other type alone."""
    return kind.members if isinstance(kind, Union) else (kind,)


def without_none(kind: Type) -> Type:
    """A type without None: what it is when it is used."""
    if isinstance(kind, Union) and NONE in kind.members:
        return union(member for member in kind.members if member is not NONE)
    return kind


def general(kind: Type) -> Type:
    """A type without its literal value: what a name can hold besides its first value."""
    if isinstance(kind, Plain) and kind.value is not None:
        return Plain(kind.kind, None, None if kind.source is PASSED else kind.source)
    return kind


def union(kinds: Iterable[Type]) -> Type:
    """One of ``kinds``; UNKNOWN as soon as one of them is, or when they are too many."""
    found: dict[Type, None] = {}
    for kind in kinds:
        for member in members(kind):
            if member is UNKNOWN:
                return UNKNOWN
            found[member] = None
    if len(found) > 1 and sum(isinstance(member, Plain) for member in found) > MOST_MEMBERS // 2:
        found = dict.fromkeys(general(member) for member in found)
    if not found:
        return UNKNOWN
    if len(found) == 1:
        return next(iter(found))
    return Union(tuple(found)) if len(found) <= MOST_MEMBERS else UNKNOWN


def join(first: Type, second: Type) -> Type:
    """What a name holds after two ways led to the same place.

    Of a list or a dictionary that is empty on one of them, what it holds on the other is all that it may hold.
    """
    if first is second or first == second:
        return first
    if is_empty(first) or is_empty(second):
        empty, other = (first, second) if is_empty(first) else (second, first)
        if any(
            isinstance(one, Mapping) == isinstance(empty, Mapping)
            for one in members(other)
            if isinstance(one, _HOLDERS)
        ):
            return other
    return union((first, second))


def is_empty(kind: Type) -> TypeGuard[Sequence | Mapping]:
    """Whether it is a list or a dictionary in which there surely is nothing."""
    return isinstance(kind, (Sequence, Mapping)) and kind.is_empty


def instance_of(kind: Type) -> Type:
    """What a class makes; UNKNOWN for what is no class, or none that is known."""
    if isinstance(kind, ClassObject):
        return Instance(kind.cls)
    return LocalInstance(kind.number) if isinstance(kind, LocalClass) else UNKNOWN


def literal(kind: Type) -> str | int | float | bool | None:
    """The value of a type that is a literal."""
    return kind.value if isinstance(kind, Plain) else None


def literal_text(kind: Type) -> str | None:
    """The text of a type that is a string literal."""
    return kind.value if isinstance(kind, Plain) and isinstance(kind.value, str) else None


def literal_texts(kind: Type) -> Iterator[str]:
    """The texts that a type can be, if it is nothing but string literals."""
    found = [literal_text(member) for member in members(kind)]
    if all(text is not None for text in found):
        yield from (text for text in found if text is not None)


ResolutionKind = Literal[
    "attribute", "store", "name", "call", "keyword", "value", "compared", "item", "text", "button", "product", "sum",
    "class",
]  # fmt: skip


@dataclass(slots=True)
class Resolution:
    """What a part of a script stands for in the API.

    ``symbols`` are the paths of the symbols it resolves to, one for each type that its owner can have: a member, an
    operator, a socket, ``operator(keyword)`` for a keyword, the property or parameter for a value. ``missing`` are
    the owners that have no such member, ``possible`` the symbols of derived classes that do. ``value`` is the
    value or the name as written. ``sure`` is False where a convention was needed, ``guarded`` is True where the
    script is ready for the opposite (``hasattr``, ``try``); ``caught`` are the names of the errors that it catches,
    where it is ready by nothing else. ``statement`` is the innermost one around it.

    Kinds: ``attribute`` and ``store`` (ast.Attribute), ``name`` (an imported or bare name), ``call`` (ast.Call),
    ``keyword`` (ast.keyword), ``value`` (a literal given to an enumeration), ``compared`` (a literal that
    one is compared with), ``item`` (ast.Subscript, or the literal key
    of a call to ``get``), ``text`` (a literal that names a property: ``keyframe_insert("location")``), ``button`` (a
    literal that names the property or the operator that a layout shows), ``product`` (a multiplication that mathutils
    refuses: ``missing`` are the classes of its two sides), ``sum`` (a sum or a quotient that it refuses, alike),
    ``class`` (a name that holds that of a class which the API lacks, given to what takes names of classes). The node of
    a ``value`` too may be a name or an item that holds the text.
    """

    node: ast.AST
    kind: ResolutionKind
    value: str
    symbols: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    possible: tuple[str, ...] = ()
    sure: bool = True
    guarded: bool = False
    statement: ast.stmt | None = None
    caught: frozenset[str] = frozenset()

    def is_ready_for(self, *errors: str) -> bool:
        """Whether the script is ready here for one of some errors of Python's; of any where none is named."""
        return self.guarded and (not (self.caught and errors) or catches(self.caught, errors))


def catches(caught: Iterable[str], errors: Iterable[str]) -> bool:
    """Whether handlers for some of Python's errors, or classes of errors, catch one of others."""
    classes = tuple(getattr(builtins, name) for name in caught)
    return any(issubclass(getattr(builtins, error), classes) for error in errors)
