"""The texts in what a call passes, and what is left of a type without them."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from kb_build.flow.values.type_parts import HOLDING, NAMES_PASSED, parts, with_parts
from kb_build.flow.values.types import FLOAT, PASSED, Mapping, Plain, Sequence, Tuple, Type, general, union

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_NUMBERS = frozenset({"int", "float"})


def texts_in(kind: Type) -> Iterator[Plain]:
    """The text literals in a type."""
    if isinstance(kind, Plain):
        if isinstance(kind.value, str):
            yield kind
    elif isinstance(kind, HOLDING):
        if isinstance(kind, Mapping):
            yield from (name for name, _ in pairs_of(kind))
        for part in parts(kind):
            yield from texts_in(part)


def pairs_of(kind: Mapping) -> list[tuple[Plain, Type]]:
    """The items of a dictionary whose keys are written out: key and value."""
    source = kind.key.source if isinstance(kind.key, Plain) else None
    return [(Plain("str", name, source), value) for name, value in kind.items]


def has_texts(kind: Type) -> bool:
    """Whether a type has a text literal."""
    return next(texts_in(kind), None) is not None


def has_passed(kind: Type) -> bool:
    """Whether a type has a text that only some calls pass."""
    return any(text.source is PASSED for text in texts_in(kind))


def passed(kind: Type) -> Type:
    """A type as a parameter holds it: each of its texts is one of those that calls pass."""
    return _each_plain(kind, _as_passed)


def for_one_call(kind: Type) -> Type:
    """A type as one of what a call passes: numbers and truth values are any, texts are those of this call."""
    return _each_plain(kind, _of_one_call, numbers=True)


def without_texts(kind: Type) -> Type:
    """A type of which no text is known, as one that many calls pass."""
    found = _each_plain(kind, general, numbers=True)
    return replace(found, items=()) if isinstance(found, Mapping) else found


def lessened(kind: Type) -> Type:
    """A list or a dictionary that something was taken out of: what was written out may not be in it any longer."""
    match kind:
        case Tuple(items=items):
            return Sequence("list", union(map(without_texts, items)))
        case Sequence():
            return replace(kind, element=without_texts(kind.element))
        case Mapping():
            return replace(kind, key=without_texts(kind.key), items=())
        case _:
            return kind


def _as_passed(kind: Plain) -> Type:
    is_text = isinstance(kind.value, str) and kind.source is None
    return Plain(kind.kind, kind.value, PASSED) if is_text else kind


def _of_one_call(kind: Plain) -> Type:
    if kind.kind in _NUMBERS or (kind.kind == "bool" and kind.source is None):
        return general(kind)
    return Plain(kind.kind, kind.value) if kind.source is PASSED else kind


def _each_plain(kind: Type, change: Callable[[Plain], Type], *, numbers: bool = False) -> Type:
    """A type with each plain part changed; with ``numbers``, a tuple of numbers is one of fractions."""
    if isinstance(kind, Plain):
        return change(kind)
    if not isinstance(kind, HOLDING):
        return kind
    if numbers and isinstance(kind, Tuple) and kind.items and all(map(_is_number, kind.items)):
        return Tuple((FLOAT,) * len(kind.items))
    found = with_parts(kind, partial(_each_plain, change=change, numbers=numbers))
    # The literal keys of a dictionary have no types of their own.
    is_passed = isinstance(found, Mapping) and found.items and change is _as_passed
    return replace(found, key=NAMES_PASSED) if is_passed else found


def _is_number(kind: Type) -> bool:
    return isinstance(kind, Plain) and kind.kind in _NUMBERS
