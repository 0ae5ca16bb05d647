"""Recognises messages of values that an enumeration lacks."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.paths import last_name, plain_path
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.likely.likely_values import likely_values

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.named_symbols import NamedSymbols
    from kb_serve.recognise.named.enum_values import EnumValues
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup

_FEW = 3
_NAMED = 0.985  # how sure a function is that a message names
_MOST_OWNERS = 8  # that are compared
_NO_ITEM = "`{name}` is not an item of this enum; closest: {similar}."
_LABELLED = "`{name}` is not an item of this enum; of that label: {items}."
_TAKEN_BY = "`{name}` is a value of {owners}."
_NOT_NOW = "`{name}` is a value of `{owner}`, which present data do not allow."
_OTHER_VERSION = "Blender {version} takes `{name}` for `{owner}`: the message is another version's."
_ONE_OF = "`{name}` is not an item of this enum, which has {items}."
_MINUS = "-"  # which a name's key does not tell
_MOST_ITEMS = 8  # that are listed
_NEVER = "RNA lists `{name}` for `{owner}`, and no {thing} comes to have it.{instead}"
_OF_PROPERTIES = "item.attr = val"


def _closest(name: str, items: Sequence[str]) -> str:
    return ", ".join(f"`{item}`" for item in likely_values(name, items))


class Values:
    """Finds in one base the enumerations that lack a value, and what has it."""

    def __init__(
        self, reader: BaseReader, removed: RemovedSymbolLookup, enum_values: EnumValues, symbols: NamedSymbols
    ) -> None:
        self._reader = reader
        self._removed = removed
        self._enum_values = enum_values
        self._symbols = symbols

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the function that a message names with its class, whatever the code beside it may be of; the owners of
        the enumeration, and what is closest to the value, or became of it.
        """
        for match in forms.first_matches(forms.IN_FUNCTION, query):
            if "." in match["method"] and (named := self._symbols.function(match["method"])):
                recognition.add(named, _NAMED, "error message")
        for match in forms.first_matches(forms.BAD_ENUM, query):
            self._listed(match["name"], re.findall(r"'([^']+)'", match["items"]), query, recognition)
        for match in forms.first_matches(forms.UNLISTED_ENUM, query):
            self._unlisted(match["name"], query, recognition)
        for match in forms.first_matches(forms.BAD_TEXT, query):
            once = [path for path in self._reader.history.removed_named(match["name"]) if "):" in path]
            if once and (removed := self._removed.of_path(once[0])):
                recognition.add_removed(removed)
            elif similar := _closest(match["name"], re.findall(r"'([^']+)'", match["items"])):
                recognition.notes.append(_NO_ITEM.format(name=match["name"], similar=similar))

    def _listed(self, value: str, items: Sequence[str], query: str, recognition: Recognition) -> None:
        """Adds what takes the items that a message lists, but not a value, and what became of that or is meant."""
        owners = self._enum_values.taking(items, self._called(query))
        if _OF_PROPERTIES in query:  # nothing was called
            owners = [owner for owner in owners if "(" not in owner] or owners
        if forms.OF_CLASSES in query:
            owners = self._of_classes(owners) or owners
        owners = self._meant_first(owners, value, items, query)[:_MOST_OWNERS]
        for rank, owner in enumerate(owners[:2]):
            recognition.add(plain_path(owner), 0.95 - 0.02 * rank, "error message")
        likely = self._enum_values.as_likely_as_the_first(owners, items)
        if removed := self._lost_value(likely, value):
            recognition.add_removed(removed)
        elif note := next(filter(None, self._notes(owners, value, items)), ""):
            recognition.notes.append(note)

    def _unlisted(self, value: str, query: str, recognition: Recognition) -> None:
        """Adds what lost a value, or else takes it somewhere, the most important first, where a message does not list
        what is taken.
        """
        lost = [path.removesuffix(f":{value}") for path in self._reader.history.removed_named(value)]
        for owners in (self._refusing(lost, query), self._refusing(self._taking(value), query)):
            if removed := self._lost_value(owners[:1], value):
                recognition.add_removed(removed)
            for rank, owner in enumerate(owners[:2]):
                recognition.add(plain_path(owner), 0.95 - 0.02 * rank, "error message")
            if owners:
                break
        else:
            return
        if note := self._enum_values.condition(owners[0], value):
            recognition.notes.append(note)

    def _called(self, query: str) -> str:
        """How what a message says was called begins: a function's name, that of any operator; empty for nothing."""
        function = forms.IN_FUNCTION.search(query)
        called = self._symbols.function(function["method"]) if function else ""
        return called or (OPERATORS if forms.OF_OPERATORS in query else "")

    def _refusing(self, owners: Iterable[str], query: str) -> list[str]:
        """Those of some owners of a value that a message may be about, the most important first: arguments of
        operators, properties, or those of the function that it names.
        """
        called = self._called(query)
        found = [owner for owner in owners if owner.startswith(called)]
        if _OF_PROPERTIES in query:
            found = [owner for owner in found if "(" not in owner]
        weights = self._reader.usage.weights(list(map(plain_path, found)))
        here = [owner for owner in found if self._reader.entry(plain_path(owner))]
        return sorted(here, key=lambda owner: -weights.get(plain_path(owner), 0.0))

    def _meant_first(self, owners: Sequence[str], value: str, items: Sequence[str], query: str) -> list[str]:
        """Owners, likeliest first; before them what code beside the message sets, and of equally likely ones those
        that take the value somewhere. Of a list that is cut so short that no owner has just these items, all are
        equally likely.
        """
        is_cut = self._enum_values.is_cut(owners, items)
        equal = owners if is_cut else self._enum_values.as_likely_as_the_first(owners[:_MOST_OWNERS], items)
        having = [owner for owner in equal if self._enum_values.has(owner, value)]
        written = [owner for owner in owners[:_MOST_OWNERS] if f".{last_name(owner)} =" in query]
        return list(dict.fromkeys((*written, *having, *owners)))

    def _notes(self, owners: Sequence[str], name: str, items: Sequence[str]) -> Iterator[str]:
        """What may be said of a value that is not among the items in a message, the surest first; empty for nothing."""
        if owners:
            owner = owners[0]
            yield self._of_another_version(owner, name, items)
            yield self._enum_values.condition(owner, name)
            if self._enum_values.has(owner, name):
                yield self._never_had(owner, name, items) or self._not_taken(owner, name)
            same = [] if name.startswith(_MINUS) else self._reader.names.enum_owners(key(name))
            spelled = (item for path, item, _ in same if path == owner)
            yield next(
                (_NO_ITEM.format(name=name, similar=f"`{item}`") for item in spelled if item != name), ""
            )
            labelled = ", ".join(f"`{item}`" for item in self._labelled(owner, name, items)[:_FEW])
            yield labelled and _LABELLED.format(name=name, items=labelled)
        beside = ", ".join(f"`{other}`" for other in self._taking_beside(owners, name))
        yield beside and _TAKEN_BY.format(name=name, owners=beside)
        similar = _closest(name, items) or self._explaining(owners, name)
        yield similar and _NO_ITEM.format(name=name, similar=similar)
        others = ", ".join(f"`{other}`" for other in self._taking_only(name)) if owners else ""
        yield others and _TAKEN_BY.format(name=name, owners=others)
        if owners and len(items) <= _MOST_ITEMS:
            yield _ONE_OF.format(name=name or "''", items=", ".join(f"`{item}`" for item in items))

    def _not_taken(self, owner: str, name: str) -> str:
        """Why a value that is there was refused: functions of RNA take the same at any time."""
        if "(" in owner and not owner.startswith(OPERATORS):
            return _OTHER_VERSION.format(name=name, owner=owner, version=self._reader.meta.get("minor", ""))
        return _NOT_NOW.format(name=name, owner=owner)

    def _never_had(self, owner: str, name: str, items: Sequence[str]) -> str:
        """That nothing comes to have a value, as a property with the same items tells that Blender alone sets; empty
        where none does.
        """
        for other, identifier, _ in self._reader.names.enum_owners(key(name)):
            symbol = self._reader.symbol(other) if identifier == name and "(" not in other else None
            if symbol is None or READ_ONLY not in symbol.flags:
                continue
            taken = {item.identifier: item.name for item in symbol.enum_items if item.is_taken}
            if name in taken or not taken.keys() >= {*items}:
                continue
            label = next(item.name for item in symbol.enum_items if item.identifier == name)
            meant = [item for item, called in taken.items() if called == label]
            instead = f" Write `{meant[0]}`." if len(meant) == 1 else ""
            thing = symbol.owner.rpartition(".")[2]
            return _NEVER.format(name=name, owner=owner, thing=thing, instead=instead)
        return ""

    def _labelled(self, owner: str, name: str, items: Sequence[str]) -> list[str]:
        """The other items whose label is a name, where spelling does not tell just these: the label is surer."""
        labelled = [item for item in self._enum_values.labelled(owner, name) if item != name]
        return [] if _closest(name, items) == ", ".join(f"`{item}`" for item in labelled) else labelled

    def _explaining(self, owners: Sequence[str], name: str) -> str:
        """The item of the likeliest owner that says what things called so are; empty for none."""
        meant = self._enum_values.explaining(owners[0], name) if owners else ()
        return ", ".join(f"`{item}`" for item in meant)

    def _taking_only(self, value: str) -> list[str]:
        """The properties that take a value, where only a few do."""
        owners = self._taking(value)
        return owners if len(owners) < _FEW and all("(" not in owner for owner in owners) else []

    def _taking_beside(self, owners: Sequence[str], value: str) -> list[str]:
        """The further properties that take a value, of the class of the likeliest owner."""
        cls = owners[0].rpartition(".")[0] if owners and "(" not in owners[0] else ""
        taking = self._taking(value) if cls else []
        return [owner for owner in taking if owner.rpartition(".")[0] == cls and owner not in owners]

    def _taking(self, value: str) -> list[str]:
        """All that takes exactly a value."""
        return [owner for owner, item, _ in self._reader.names.enum_owners(key(value)) if item == value]

    def _lost_value(self, owners: Iterable[str], value: str) -> RemovedSymbol | None:
        """A value that the likeliest owners took in other versions; where several did, one of which the successor is
        known.
        """
        found: list[RemovedSymbol] = []
        for owner in owners:
            path = plain_path(owner)
            if removed := self._removed.of_part(path, f"{owner.removeprefix(path)}:{value}"):
                found.append(removed)
        return min(found, key=lambda removed: not removed.targets, default=None)

    def _of_another_version(self, owner: str, value: str, items: Iterable[str]) -> str:
        """A sentence on a value that this version takes, where the items in the message are another version's."""
        if not self._enum_values.has(owner, value):
            return ""
        for item in items:
            removed = None if self._enum_values.has(owner, item) else self._removed.of_path(f"{owner}:{item}")
            if removed and removed.gone:
                version = self._reader.meta.get("minor", "")
                near = _closest(value, [item])
                there = f" There, write `{item}`." if near else ""
                return (
                    f"Blender {version} takes `{value}` for `{owner}`. The list in the message is another version's: "
                    f"only Blender {removed.first} to {removed.last} have `{item}`.{there}"
                )
        return ""

    def _of_classes(self, owners: Iterable[str]) -> list[str]:
        """Those of some properties that classes set to be registered, the most important first."""
        found = [owner for owner in owners if owner.rpartition(".")[2].startswith("bl_")]
        weights = self._reader.usage.weights(found)
        return sorted(found, key=lambda owner: -weights.get(owner, 0.0))
