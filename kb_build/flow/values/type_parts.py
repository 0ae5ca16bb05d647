"""The types within a type, and what is asked of, or done to, each of them."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from kb_build.flow.values.types import (
    PASSED,
    UNKNOWN,
    Builtin,
    ClassObject,
    Collection,
    FromNames,
    FromVersion,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    LocalModule,
    Mapping,
    Module,
    NoneValue,
    Operator,
    Plain,
    Sequence,
    Telling,
    Tuple,
    Type,
    Union,
    Unknown,
    is_empty,
    members,
    union,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from collections.abc import Collection as Group
    from collections.abc import Mapping as Rows

DEEPEST_TYPE = 6  # parts within each other of what a name holds
# What a dictionary's literal keys are, which some call has and others not.
NAMES_PASSED = Plain("str", None, PASSED)
HOLDING = (Union, Tuple, Sequence, Mapping)  # all that have parts
_WITHOUT_PARTS = frozenset(
    {Unknown, NoneValue, Plain, Module, ClassObject, Operator, LocalModule, LocalClass, LocalInstance}
)


def parts(kind: Type) -> tuple[Type, ...]:
    """What a type is made of: the members of a union, what a list or a dictionary holds. Not what it was read from."""
    match kind:
        case Union():
            return kind.members
        case Tuple():
            return kind.items
        case Sequence():
            return (kind.element,)
        case Mapping():
            return (kind.key, kind.value, *(value for _, value in kind.items))
        case _:
            return ()


def with_parts(kind: Type, change: Callable[[Type], Type]) -> Type:
    """The same type made of changed parts."""
    match kind:
        case Union():
            return union(map(change, kind.members))
        case Tuple():
            return Tuple(tuple(map(change, kind.items)))
        case Sequence():
            return replace(kind, element=change(kind.element))
        case Mapping():
            items = tuple((name, change(value)) for name, value in kind.items)
            return replace(kind, key=change(kind.key), value=change(kind.value), items=items)
        case _:
            return kind


def by_names(values: Rows[str, Type]) -> Mapping:
    """The dictionary of what is given by names."""
    names = union(Plain("str", name) for name in values)
    return Mapping(names, union(values.values()), tuple(values.items()), is_empty=not values)


def given_away(kind: Type) -> Type:
    """A type as that of what others were given, who may have filled it: nothing in it surely is empty."""
    if is_empty(kind):
        return replace(kind, is_empty=False)
    return with_parts(kind, given_away) if isinstance(kind, HOLDING) else kind


def bounded(kind: Type, depth: int = DEEPEST_TYPE) -> Type:
    """A type whose parts lie at most so deep within each other: a list that holds itself has no end.

    What a type was read from counts as a part here: that can have no end either.
    """
    if type(kind) in _WITHOUT_PARTS:
        return kind
    if depth == 0:
        return UNKNOWN
    below = partial(bounded, depth=depth - 1)
    match kind:
        case Instance() if kind.traits:
            return replace(kind, traits=tuple((name, below(trait)) for name, trait in kind.traits))
        case Function() | Builtin() | LocalFunction() if kind.receiver is not None:
            return replace(kind, receiver=below(kind.receiver))
        case Collection():
            return replace(kind, owner=below(kind.owner))
        case _:
            return with_parts(kind, below)


def without_parts(kind: Type, known: Group[Type]) -> Type:
    """A type in which nothing is known of what is one of those, or a dictionary of the same names."""
    if any(_is_again(kind, one) for one in known):
        return UNKNOWN
    return with_parts(kind, partial(without_parts, known=known)) if isinstance(kind, HOLDING) else kind


def _is_again(kind: Type, known: Type) -> bool:
    if isinstance(kind, Mapping) and isinstance(known, Mapping) and kind.items:
        return [name for name, _ in kind.items] == [name for name, _ in known.items]
    return kind == known


def unsure(kind: Type) -> Type:
    """A type that is only one of those that a value may have."""
    match kind:
        case Instance():
            return replace(
                kind, sure=False, traits=tuple((name, unsure(trait)) for name, trait in kind.traits)
            )
        case Plain():
            return Plain(kind.kind, None, tells(kind))
        case Mapping() if kind.items:
            return replace(with_parts(kind, unsure), key=NAMES_PASSED)
        case _:
            return with_parts(kind, unsure)


def can_be_unsure(kind: Type) -> bool:
    """Whether :func:`unsure` marks everything in a type that an error could be told of."""
    if isinstance(kind, HOLDING):
        return all(map(can_be_unsure, parts(kind)))
    return isinstance(kind, (Unknown, Plain, Instance, NoneValue))


def tells(kind: Type) -> Telling | None:
    """The source by which a value, or a part of it, tells of this Blender.

    A dictionary tells nothing: one of its values may, and then tells it where it is read.
    """
    for member in members(kind):
        found = None
        if isinstance(member, Plain):
            found = member.source if isinstance(member.source, (FromVersion, FromNames)) else None
        elif isinstance(member, (Tuple, Sequence)):
            found = next(filter(None, map(tells, parts(member))), None)
        if found:
            return found
    return None


def is_computed(kind: Type) -> bool:
    """Whether a plain value was computed: its literal is not known."""
    return isinstance(kind, Plain) and kind.value is None


def telling(kind: Type, source: Telling | None, *, value: bool = False) -> Type:
    """A plain type as one that tells of this Blender, by ``source`` if any; its literal stays with ``value``.

    A list or a dictionary stays as it is, and so do what it holds: they are not all chosen by what was told. Only what
    a row of computed values gives was: the numbers of a version.
    """
    if source is None:
        return kind
    if isinstance(kind, Sequence) and is_computed(kind.element):
        return Sequence(kind.kind, telling(kind.element, source))
    if isinstance(kind, Union):
        return with_parts(kind, partial(telling, source=source))
    if isinstance(kind, Plain) and (kind.source is None or kind.source is PASSED):
        return Plain(kind.kind, kind.value if value else None, source)
    return kind


def entered(kind: Type) -> Type:
    """What ``with`` gives: of a generator, which only a decorator makes a context manager, what it yields."""
    yielded = [one.element for one in members(kind) if isinstance(one, Sequence) and one.kind == "iterator"]
    return union(yielded) if yielded else kind
