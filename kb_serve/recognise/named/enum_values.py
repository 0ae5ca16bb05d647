"""Recognises enum values (``'EMITTER'``, ``view_transform 'AgX'``): the properties that take them."""

from __future__ import annotations

import re
from collections import defaultdict
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import operator_areas
from kb_build.symbols.lines import taken_text
from kb_build.symbols.paths import argument_of, plain_path
from kb_build.symbols.records import EnumItem
from kb_serve.recognise.likely.likely_values import (
    explaining,
    labelled_items,
    likely_items,
    same_elsewhere,
)
from kb_serve.recognise.recognition import WHOLE_LABEL

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.taken import Taken
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_QUOTED = re.compile(r"'([^'\n]{2,60})'|\"([^\"\n]{2,60})\"")
_WHOLE = re.compile(r"(['\"])([^'\"\n]{2,60})\1")
# What an element is looked up by, as ``objects["Cube"]``, which is its name.
_SUBSCRIPT = re.compile(r"""(?<=[\w)\]])\[(['"])([^'"\n]{2,60})\1\]""")
# Why something was recognised that is called as the whole query.
_LABELS = frozenset({"label", "name", "title"})
_CAPITALS = re.compile(r"(?<![\w.])(?=[0-9]*[A-Z])[A-Z0-9_]{3,}(?![\w.(])")
_ERROR = re.compile(r"\b[A-Z]\w*(?:Error|Exception|Warning)\b:?")
_MOST_VALUES = 40
_MOST_TOLD = 5  # enumerations
_ICON = "icon"
_OF_INTERFACE = 0.4  # what an owner fits that is of Blender's windows, of what one fits that a script sets
_PREFERENCES = f"{TYPES}Preferences"
_MOST_COMPARED = 20  # enumerations of which as many items are listed
_FITTING = 0.5  # how well the words around a bare value must fit its property
_FITTING_WORD = 1.0  # the same for one that people write in capitals, too: EEVEE, PNG
_SHARE = 0.6  # … in a question of many words, of which one fits some property by chance


def is_value(text: str, reader: BaseReader) -> bool:
    """Whether a text in capitals is an item of some enumeration."""
    return text.isupper() and any(
        text == identifier for _, identifier, _ in reader.names.enum_owners(key(text))
    )


def is_quoted_value(query: str, reader: BaseReader) -> bool:
    """Whether a whole query is such an item in quotes: ``'EMITTER'``, then no page or class of that name is meant."""
    quoted = _WHOLE.fullmatch(query.strip())
    return quoted is not None and is_value(quoted[2], reader)


def _is_taken(item: EnumItem, mode: Taken | None) -> bool:
    """Whether an item is taken in a mode, ``with media_type='VIDEO'``; None for none of those named."""
    where = item.where
    return where is None or (where.condition == mode) != (where.how == "not")


def _is_of_icons(owner: str) -> bool:
    """Whether an enumeration is one of icons: there is one for any word."""
    return _ICON in terms(owner.rpartition(".")[2].replace("(", " "))


def _is_a_label(recognition: Recognition) -> bool:
    """Whether something is called as the whole query: "mesh to SDF grid" asks for a node, and not for ``SDF``."""
    return any(match.why in _LABELS and match.sure >= WHOLE_LABEL for match in recognition.matches)


class EnumValues:
    """Recognises enum values against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition, classes: frozenset[str] = frozenset()) -> None:
        """Adds the properties and parameters that take the values in a query, and quoted classes.

        ``classes`` are what a message names as the classes of things: no values.
        """
        if not (possible := self.values(query)) and not classes:
            return
        text = _ERROR.sub(" ", query)
        quoted = [a or b for a, b in _QUOTED.findall(text)][:_MOST_VALUES]
        names = {name for _, name in _SUBSCRIPT.findall(query) if not name.isupper()}
        values = [value for value in possible if value not in names and value not in classes]
        if not values and not classes:
            return
        for value in quoted:
            for entry in self._reader.names.by_name(value):
                if entry.kind == "class":
                    recognition.add(entry.path, 0.82, "quoted name")
        if not values:
            return
        rest = text
        for value in values:
            rest = rest.replace(value, " ")
        around = set(terms(rest))
        alone = not around
        owners = self._by_use(list(self.owners(values, around)), set() if alone else around)
        told = (row for row in owners if alone or _ICON in around or not _is_of_icons(row[0]))
        for rank, (owner, share) in enumerate(islice(told, _MOST_TOLD)):
            least = max(_FITTING_WORD, _SHARE * len(around)) if self._is_word(owner, values) else _FITTING
            fits = alone or quoted or self._owner_fit(owner, around) >= least
            fits = fits and (bool(quoted) or not _is_a_label(recognition))
            sure = (0.97 if alone else 0.9 if fits else 0.45) * (0.6 + 0.4 * share) - 0.03 * rank
            recognition.add(plain_path(owner), sure, "enum item")

    def _by_use(self, owners: list[tuple[str, float]], around: set[str]) -> list[tuple[str, float]]:
        """Owners with their shares of the values, of those that fit the words around as well those that count most
        first; with no words all, as nothing else tells which is meant.
        """
        fit = (
            {owner: self._fit_for_scripts(owner, around) for owner, _ in owners[:_MOST_COMPARED]}
            if around
            else {}
        )
        compared = [row for row in owners if not around or row[0] in fit]
        weights = self._reader.usage.weights([plain_path(owner) for owner, _ in compared])
        compared.sort(key=lambda row: (-row[1], -fit.get(row[0], 0.0), -weights.get(plain_path(row[0]), 0.0)))
        return [*compared, *owners[len(compared) :]]

    @staticmethod
    def values(query: str) -> list[str]:
        """Possible values: the first quoted texts and words in capitals."""
        if query.islower() and "'" not in query and '"' not in query:
            return []
        text = _ERROR.sub(" ", query)
        found = dict.fromkeys([*(a or b for a, b in _QUOTED.findall(text)), *_CAPITALS.findall(text)])
        return list(found)[:_MOST_VALUES]

    def owners(self, values: Iterable[str], around: set[str] | None = None) -> Iterator[tuple[str, float]]:
        """(owner, share of the values that it has), by that share, then by fit to the other words."""
        wanted = list(values)[:_MOST_VALUES]
        held: dict[str, set[str]] = defaultdict(set)
        for value in wanted:
            for owner, identifier, name in self._reader.names.enum_owners(key(value)):
                if value == identifier or (value == name and not self._is_class(value)):
                    held[owner].add(value)
        self._reader.entry.load(plain_path(owner) for owner in held)
        for owner in sorted(
            held, key=lambda o: (-len(held[o]), -self._owner_fit(o, around or set()), len(o), o)
        ):
            yield owner, len(held[owner]) / max(1, len(wanted))

    def taking(self, items: Sequence[str], called: str) -> list[str]:
        """The owners of the items that a message lists, likeliest first: those of the function that was called, or else
        those that have most of them; of these, those that take just these, in one of their modes.
        """
        shares = list(self.owners(items))
        beyond = {
            owner: self._difference(owner, set(items)) for owner, share in shares if share == shares[0][1]
        }
        of_called = [row for row in shares if called and row[0].startswith(called)]
        likeliest = of_called or [row for row in shares if row[1] == shares[0][1]]
        weights = self._reader.usage.weights([plain_path(owner) for owner, _ in likeliest])
        likeliest.sort(
            key=lambda row: (-row[1], beyond.get(row[0], 0), -weights.get(plain_path(row[0]), 0.0))
        )
        return [owner for owner, _ in likeliest]

    def as_likely_as_the_first(self, owners: Sequence[str], items: Sequence[str]) -> list[str]:
        """Of the owners of the items in a message, likeliest first, those that nothing sets apart from the first:
        they take as few others.
        """
        beyond = {owner: self._difference(owner, set(items)) for owner in owners}
        return [owner for owner in owners if beyond[owner] == beyond[owners[0]]]

    def is_cut(self, owners: Sequence[str], items: Sequence[str]) -> bool:
        """Whether even the likeliest owner of the items in a message takes as many others as are listed."""
        return bool(owners) and self._difference(owners[0], set(items)) >= len(items)

    def has_any(self, value: str) -> bool:
        """Whether any enumeration has an item that is spelled just so."""
        return any(identifier == value for _, identifier, _ in self._reader.names.enum_owners(key(value)))

    def has(self, owner: str, value: str) -> bool:
        """Whether an enumeration takes a value, somewhere."""
        return any(item.identifier == value for item in self._items(owner))

    def where(self, owner: str, value: str) -> Taken | None:
        """Where an enumeration takes a value; None for everywhere, or nowhere."""
        return next((item.where for item in self._items(owner) if item.identifier == value), None)

    def labelled(self, owner: str, value: str) -> list[str]:
        """The items of an enumeration whose labels say a value; see :func:`likely_values.labelled_items`."""
        return labelled_items(value, self._items(owner))

    def likely(self, owner: str, value: str, values: Iterable[str]) -> list[str]:
        """Which of ``values``, that an enumeration takes, may be meant by one that it lacks."""
        items = {item.identifier: item for item in self._items(owner)}
        return likely_items(value, [items.get(one) or EnumItem(one) for one in values], self._reader)

    def explaining(self, owner: str, value: str) -> list[str]:
        """The item that says what things called as a value are, if there is one."""
        return explaining(value, self._items(owner), self._reader)

    def condition(self, owner: str, value: str) -> str:
        """A sentence on where an enumeration takes a value, and those of its name; "" if everywhere, or nowhere."""
        where = self.where(owner, value)
        if not where:
            return ""
        others = same_elsewhere(value, (item.identifier for item in self._items(owner)))
        taken = ((other, found) for other in others if (found := self.where(owner, other)))
        elsewhere = "".join(f"; `'{other}'` is {taken_text(found)}" for other, found in taken)
        return f"`{owner}` = '{value}' is {taken_text(where)}{elsewhere}."

    def _difference(self, owner: str, values: set[str]) -> int:
        """How many items an enumeration has more or less than some, in that of its modes in which that is fewest; older
        versions may have had no modes, and all items at once.
        """
        items = self._items(owner)
        modes = {item.where and item.where.condition for item in items}
        taken = [{item.identifier for item in items if _is_taken(item, mode)} for mode in modes]
        taken.append({item.identifier for item in items})
        return min(len(values ^ identifiers) for identifiers in taken)

    def _items(self, owner: str) -> tuple[EnumItem, ...]:
        """The items that a property, or a function's parameter, takes somewhere, or that a function returns."""
        symbol, parameter = self._reader.symbol(plain_path(owner)), argument_of(owner)
        if symbol is None:
            return ()
        named = (given.enum_items for given in symbol.parameters if given.name == parameter)
        own = symbol.enum_items or [item for returned in symbol.returns for item in returned.enum_items]
        items = next(named, ()) if parameter else own
        return tuple(item for item in items if item.is_taken)

    def _is_word(self, owner: str, values: Sequence[str]) -> bool:
        """Whether the values that an enumeration has are words of people too: as it shows them, or names of classes."""
        held = [item for item in self._items(owner) if item.identifier in values]
        return (bool(held) and all(item.identifier == item.name for item in held)) or all(
            map(self._is_class, values)
        )

    def _is_class(self, value: str) -> bool:
        """Whether a label, ``Matrix``, is the name of a class: then it is hardly meant as an item."""
        return any(entry.kind == "class" for entry in self._reader.names.by_name(value))

    def _fit_for_scripts(self, owner: str, around: set[str]) -> float:
        """How well an owner fits the words around; less, if it is an operator that an editor must be open for, or of
        the preferences: of Blender, not of what is made with it.
        """
        fit = self._owner_fit(owner, around)
        if not argument_of(owner):
            return fit * (_OF_INTERFACE if owner.startswith(_PREFERENCES) else 1.0)
        symbol = self._reader.symbol(plain_path(owner))
        return fit * (_OF_INTERFACE if symbol and operator_areas(symbol) else 1.0)

    def _owner_fit(self, owner: str, around: set[str]) -> float:
        entry, parameter = self._reader.entry(plain_path(owner)), argument_of(owner)
        if entry is None:
            return -1.0
        about = set(terms(f"{entry.name} {entry.label} {parameter}"))
        beyond = set(terms(entry.owner.replace(TYPES, "").replace("bpy.ops", "")))
        return len(about & around) + 0.6 * len(beyond & around) - (0.3 if parameter else 0.0)
