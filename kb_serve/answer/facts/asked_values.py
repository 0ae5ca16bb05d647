"""The arguments and values of a symbol that a question speaks of: ``type='CROSS'`` for ``crossfade two strips``."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import terms

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.symbols.records import EnumItem, Symbol

MOST = 3
# Of arguments that most functions have, and of values that say little by themselves.
_COMMON = frozenset(
    """type mode data object name valu index key file path use none default auto all custom action other set new
    add""".split()  # noqa: SIM905
)
# Of arguments of those that have very many, what is hardly said with the rest: ``use_selection``, ``bake_anim``.
_UNSAID = frozenset({"bake", "export", "import", "object", "only", "use"})
_VERY_MANY = 20
_OF_DIALOGS = "ui_"
# What follows these is not wanted, up to the next of the words that go on.
_NOT_WANTED = re.compile(
    r"\b(?:not|without|no|except|excluding|but\snot|instead\sof|rather\sthan)\b.*?(?=[,.;]|\b(?:and|but|then)\b|$)",
    re.I | re.S,
)


class AskedValue(NamedTuple):
    """An argument, or the value of one or of the symbol itself, as Python source.

    ``words``: how many words asked for it; ``in_order``: whether as it has them; ``in_set``: whether the argument takes
    a set of values.
    """

    argument: str
    value: str
    words: int
    in_order: bool
    in_set: bool = False

    @property
    def text(self) -> str:
        """``type='SUN'``; the value or the argument alone where there is no other."""
        given = f"{{{self.value}}}" if self.in_set else self.value
        return "=".join(filter(None, (self.argument, given)))


def asked_words(question: str) -> tuple[str, ...]:
    """The stems of the words by which a question asks for something, in their order."""
    return tuple(terms(_NOT_WANTED.sub(" ", question)))


def unsaid(path: str, label: str, asked: Iterable[str]) -> frozenset[str]:
    """Of the words ``asked`` (stems) those that neither the symbol itself says, nor most others."""
    return frozenset(asked) - {*terms(path), *terms(label)} - _COMMON


def asked_values(symbol: Symbol, asked: Sequence[str]) -> list[AskedValue]:
    """What of a symbol the words ``asked`` (stems) speak of besides the symbol itself, most words first."""
    left = unsaid(symbol.path, symbol.label, asked)
    if not left:
        return []
    told = _Told(asked, left)
    found = [*told.arguments(symbol), *told.values(symbol.enum_items, "")]
    return sorted(found, key=lambda value: (-value.words, not value.in_order))[:MOST]


class AskedOf(NamedTuple):
    """What a question asks of a symbol: the arguments that are told already, and values (as Python source) by argument.

    The argument of the symbol's own values is empty.
    """

    told: frozenset[str] = frozenset()
    values: Mapping[str, frozenset[str]] = MappingProxyType({})


ASKED_NOTHING = AskedOf()


def asked_of(found: Iterable[AskedValue], told: Iterable[str] = ()) -> AskedOf:
    """The same from what was found in a question; ``told`` are the arguments that are told already."""
    values: dict[str, set[str]] = {}
    for value in found:
        if value.value:
            values.setdefault(value.argument, set()).add(value.value)
    return AskedOf(frozenset(told), {name: frozenset(each) for name, each in values.items()})


class _Told:
    """What a question says, and of that what the symbol does not say itself."""

    def __init__(self, asked: Sequence[str], left: frozenset[str]) -> None:
        self._places = {word: place for place, word in enumerate(asked)}
        self._left = left

    def arguments(self, symbol: Symbol) -> Iterator[AskedValue]:
        alone: set[str] = set()  # values that one argument takes alone
        for parameter in symbol.parameters:
            if parameter.name.startswith(_OF_DIALOGS):
                continue
            values = [*self.values(parameter.enum_items, parameter.name)]
            if isinstance(parameter.default, list):  # an argument that takes a set: not one value said twice
                values = [value._replace(in_set=True) for value in values if value.value not in alone]
            else:
                alone |= {value.value for value in values}
            unsaid = _UNSAID if len(symbol.parameters) > _VERY_MANY else frozenset[str]()
            names = (parameter.name, parameter.label)
            yield from values or self._asked(parameter.name, "", *names, unsaid=unsaid)

    def values(self, items: tuple[EnumItem, ...], argument: str) -> Iterator[AskedValue]:
        for item in items:
            if item.is_taken:
                yield from self._asked(argument, repr(item.identifier), item.name, item.identifier)

    def _asked(
        self, argument: str, value: str, *names: str, unsaid: frozenset[str] = frozenset()
    ) -> Iterator[AskedValue]:
        """One, if all words of one of its names are asked for, but ``unsaid`` ones; one is not the symbol's."""
        for name in names:
            own = [word for word in terms(name) if word not in unsaid]
            places = [self._places.get(word, -1) for word in own]
            if places and min(places) >= 0 and not self._left.isdisjoint(own):
                yield AskedValue(argument, value, len(places), places == sorted(places))
                return
