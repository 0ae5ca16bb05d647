"""The texts in what a call passes, and what is left of a type without them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.types import FLOAT, PASSED, Mapping, Plain, Sequence, Tuple, Type, Union, general, union

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_NUMBERS = frozenset({"int", "float"})
_WITH_PARTS = (Plain, Tuple, Union, Sequence, Mapping)


def texts_in(kind: Type) -> Iterator[Plain]:
    """The text literals in a type."""
    if not isinstance(kind, _WITH_PARTS):
        return
    match kind:
        case Plain(kind="str", value=str()):
            yield kind
        case Tuple(items=parts) | Union(members=parts):
            for part in parts:
                yield from texts_in(part)
        case Sequence():
            yield from texts_in(kind.element)
        case Mapping():
            yield from (name for name, _ in pairs_of(kind))
            for part in (kind.value, *(value for _, value in kind.items)):
                yield from texts_in(part)
        case _:
            pass


def pairs_of(kind: Mapping) -> list[tuple[Plain, Type]]:
    """The items of a dictionary whose keys are written out: key and value."""
    source = kind.key.source if isinstance(kind.key, Plain) else ""
    return [(Plain("str", name, source), value) for name, value in kind.items]


def has_texts(kind: Type) -> bool:
    """Whether a type has a text literal."""
    return next(texts_in(kind), None) is not None


def has_passed(kind: Type) -> bool:
    """Whether a type has a text that only some calls pass."""
    return any(text.source == PASSED for text in texts_in(kind))


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


def _as_passed(kind: Plain) -> Type:
    is_text = isinstance(kind.value, str) and not kind.source
    return Plain(kind.kind, kind.value, PASSED) if is_text else kind


def _of_one_call(kind: Plain) -> Type:
    if kind.kind in _NUMBERS or (kind.kind == "bool" and not kind.source):
        return general(kind)
    return Plain(kind.kind, kind.value) if kind.source == PASSED else kind


def _change_key(kind: Mapping, change: Callable[[Plain], Type]) -> Type:
    """What the keys of a dictionary are; its literal ones have no types of their own."""
    if kind.items and change is _as_passed:
        return Plain("str", None, PASSED)
    return _each_plain(kind.key, change)


def _each_plain(  # noqa: PLR0911 - one return a type
    kind: Type, change: Callable[[Plain], Type], *, numbers: bool = False
) -> Type:
    """A type with each plain part changed; with ``numbers``, a tuple of numbers is one of fractions."""

    if not isinstance(kind, _WITH_PARTS):
        return kind
    if isinstance(kind, Plain):
        return change(kind)

    def each(part: Type) -> Type:
        return _each_plain(part, change, numbers=numbers)

    match kind:
        case Tuple(items=items):
            if numbers and items and all(isinstance(one, Plain) and one.kind in _NUMBERS for one in items):
                return Tuple((FLOAT,) * len(items))
            return Tuple(tuple(map(each, items)))
        case Union():
            return union(map(each, kind.members))
        case Sequence():
            return replace(kind, element=each(kind.element))
        case Mapping():
            pairs = tuple((name, each(value)) for name, value in kind.items)
            return Mapping(_change_key(kind, change), each(kind.value), pairs)
