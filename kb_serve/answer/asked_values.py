"""The arguments and values of a symbol that a question speaks of: ``type='CROSSFADE'`` for ``crossfade two strips``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import terms
from kb_build.records import NOT_TAKEN

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from kb_build.records import EnumItem, Symbol

MOST = 3
# Of arguments that most functions have, and of values that say little by themselves.
_COMMON = frozenset(
    """type mode data object name valu index key file path use none default auto all custom action other set new
    add""".split()  # noqa: SIM905
)
_CALLED = {"operator", "function"}
_CUT = "|…"


class AskedValue(NamedTuple):
    """An argument, or the value of one or of the symbol itself, as Python source; how many words asked for it."""

    text: str
    argument: str
    words: int


def may_have_more(kind: str, line: str) -> bool:
    """Whether a symbol's line leaves out arguments or values."""
    return (kind in _CALLED and "()" not in line.partition("`")[2]) or (kind == "property" and _CUT in line)


def asked_values(symbol: Symbol, asked: Collection[str]) -> list[AskedValue]:
    """What of a symbol the words ``asked`` (stems) speak of besides the symbol itself, most words first."""
    own = {*terms(symbol.path), *terms(symbol.label)}
    left = frozenset(asked) - own
    if not left:
        return []
    found = [
        *_arguments(symbol, frozenset(asked), left),
        *_values(symbol.enum_items, "", frozenset(asked), left),
    ]
    return sorted(found, key=lambda value: -value.words)[:MOST]


def _arguments(symbol: Symbol, asked: frozenset[str], left: frozenset[str]) -> Iterator[AskedValue]:
    for parameter in symbol.parameters:
        values = [*_values(parameter.enum_items, parameter.name, asked, left)]
        yield from values
        words = max(_spoken(text, asked, left) for text in (parameter.name, parameter.label))
        if words and not values:
            yield AskedValue(parameter.name, parameter.name, words)


def _values(
    items: tuple[EnumItem, ...], argument: str, asked: frozenset[str], left: frozenset[str]
) -> Iterator[AskedValue]:
    for item in items:
        words = max(_spoken(item.identifier, asked, left), _spoken(item.name, asked, left))
        if words and item.where != NOT_TAKEN:
            value = repr(item.identifier)
            yield AskedValue(f"{argument}={value}" if argument else value, argument, words)


def _spoken(text: str, asked: frozenset[str], left: frozenset[str]) -> int:
    """How many words a name has, if all are asked for, and one that is not the symbol's own; else 0."""
    words = frozenset(terms(text))
    return len(words) if words <= asked and not words.isdisjoint(left - _COMMON) else 0
