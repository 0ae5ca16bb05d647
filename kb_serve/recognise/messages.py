"""Recognises Blender's error messages: the symbols they are about, and what they mean."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_serve.reader import TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.calls import NO_OVERRIDE, OVERRIDE, unknown_keywords
from kb_serve.recognise.corrections import nearest
from kb_serve.recognise.recognition import MissingName

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader, SymbolEntry
    from kb_serve.recognise.corrections import RemovedSymbol, RemovedSymbolLookup
    from kb_serve.recognise.enum_values import EnumValues
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.resolver import Resolver

_FEW = 3
_MANY = 8  # where more properties may be None, none is likely enough to be named
# Pages of the API's own guides that explain a kind of message; named where the base has them.
_ON_OPERATORS = "info_gotchas_operators"
_ON_FREED = "info_gotchas_crashes"


def _matches(pattern: re.Pattern[str], query: str) -> Iterator[re.Match[str]]:
    """The first matches: a log with more of them repeats itself."""
    return islice(pattern.finditer(query), _MANY)


class Messages:
    """Recognises error messages against one base."""

    def __init__(
        self, reader: BaseReader, resolver: Resolver, removed: RemovedSymbolLookup, enum_values: EnumValues
    ) -> None:
        self._reader = reader
        self._resolver = resolver
        self._removed = removed
        self._enum_values = enum_values

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what a message is about: a class without an attribute, an operator, the owner of an enum."""
        self._attributes(query, recognition)
        self._operators(query, recognition)
        self._values(query, recognition)
        self._data(query, recognition)

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds notes that need the query's names: the right argument, a removed socket."""
        for match in _matches(forms.BAD_KEYWORD, query):
            self._keyword(match["name"], recognition)
        for match in _matches(forms.NO_KEY, query):
            self._key(match["on"], match["name"], query, recognition)

    # Attributes

    def _attributes(self, query: str, recognition: Recognition) -> None:
        for pattern in (forms.HAS_NO, forms.MODULE_HAS_NO):
            for match in _matches(pattern, query):
                if match["owner"] == "NoneType":
                    self._none(match["name"], query, recognition)
                    continue
                owner = self._class_path(match["owner"])
                if removed := self._removed_owner(match["owner"], match["name"], owner):
                    recognition.removed.extend(removed)
                elif owner and not self._resolver.member(owner, match["name"]):
                    recognition.missing.append(MissingName(match["name"], owner))
                    recognition.add(owner, 0.6, "error message")
        for match in _matches(forms.READ_ONLY, query):
            owner = "bpy.context" if match["context"] else TYPES + match["owner"]
            entry = self._named(owner, match["context"] or match["name"])
            if entry:
                recognition.add(entry.path, 0.98, "error message")
                recognition.notes.append(f"`{entry.path}` is read-only: it cannot be assigned.")
        for match in _matches(forms.WRONG_TYPE, query):
            if match["path"] and (entry := self._named(*match["path"].rpartition(".")[::2])):
                recognition.add(entry.path, 0.98, "error message")

    def _none(self, name: str, query: str, recognition: Recognition) -> None:
        """What may have been None before ``.name``: the pointers to classes that have the name."""
        recognition.notes.append(
            f"The object before `.{name}` is None: it does not exist (yet), or was not found."
        )
        owners = {
            entry.owner.removeprefix(TYPES)
            for entry in self._reader.by_name(name)
            if entry.kind in {"property", "function"}
            and entry.owner.startswith(TYPES)
            and entry.group != "ui"
        }
        holders = [
            entry
            for owner in sorted(owners)[:_MANY]
            for entry in self._reader.pointing_at(owner)
            if entry.group != "ui" and not self._is_never_none(entry)
        ]
        around = set(terms(query))
        likely = [
            entry for entry in holders if set(terms(f"{entry.owner} {entry.name}")) <= around | {"type"}
        ]
        if len(owners) <= _FEW and len(holders) <= _MANY:
            likely = likely or holders
        for rank, entry in enumerate(likely[:_FEW]):
            recognition.add(entry.path, 0.86 - 0.01 * rank, "may be None")
            recognition.add(f"{TYPES}{entry.target}.{name}", 0.81 - 0.01 * rank, "attribute of None")

    def _is_never_none(self, entry: SymbolEntry) -> bool:
        symbol = self._reader.symbol(entry.path)
        return symbol is not None and "never-none" in symbol.flags

    def _removed_owner(self, written: str, name: str, owner: str) -> list[RemovedSymbol]:
        """The members, or else the classes, that other versions had under a name that is no class in this one."""
        if self._reader.entry(TYPES + written):
            return []
        members = [*self._removed.spelled(f"{written}.{name}")]
        return members if members or owner else [*self._removed.spelled(written)]

    def _class_path(self, name: str) -> str:
        for candidate in (TYPES + name, name):
            if self._reader.entry(candidate):
                return candidate
        for _, identifier in self._reader.by_key(key(name)):
            entry = self._reader.entry(identifier)
            if entry and entry.kind in {"class", "module"}:
                return identifier
        return ""

    def _named(self, owner: str, name: str) -> SymbolEntry | None:
        cls = self._class_path(owner)
        return (self._resolver.member(cls, name) or self._reader.entry(f"{cls}.{name}")) if cls else None

    # Operators

    def _operators(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.POLL, query):
            if self._reader.entry(match["path"]):
                recognition.add(match["path"], 0.98, "error message")
                recognition.notes.append(
                    f"`{match['path']}.poll()` failed: the operator needs another mode, active object, selection "
                    f"or editor than the context has. `{OVERRIDE}` can provide it."
                )
                self._page(_ON_OPERATORS, recognition)
                recognition.add(OVERRIDE, 0.82, "error message")
        for match in _matches(forms.WRONG_TYPE, query):
            if match["operator"]:
                module, _, name = match["operator"].partition("_OT_")
                if entry := self._reader.entry(f"bpy.ops.{module.lower()}.{name}"):
                    recognition.add(entry.path, 0.98, "error message")
        if forms.POSITIONAL.search(query):
            recognition.notes.append(NO_OVERRIDE)
            recognition.add(OVERRIDE, 0.9, "error message")
            self._page(_ON_OPERATORS, recognition)
        for match in _matches(forms.NOT_AN_OPERATOR, query):
            names = self._reader.members("bpy.ops").keys() | self._reader.members("bmesh.ops").keys()
            for name, alike in nearest(match["name"], names, _FEW):
                if entry := self._reader.entry(f"bmesh.ops.{name}"):
                    recognition.add(entry.path, max(0.82, 0.95 * alike), "similar name")
            recognition.notes.append(f"`bmesh.ops` has no `{match['name']}`.")

    def _keyword(self, name: str, recognition: Recognition) -> None:
        """The arguments most like an unknown one, by the surest match that has any."""
        for match in sorted(recognition.matches, key=lambda match: -match.sure):
            symbol = self._reader.symbol(match.id)
            if symbol is not None and symbol.parameters:
                recognition.notes += unknown_keywords(symbol, [name])
                return

    # Values

    def _values(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.BAD_ENUM, query):
            items = re.findall(r"'([^']+)'", match["items"])
            for rank, (owner, _) in enumerate(self._enum_values.owners(items)):
                if rank >= 2:
                    break
                path = owner.partition("(")[0]
                recognition.add(path, 0.95 - 0.02 * rank, "error message")
                if removed := self._removed.of_path(f"{path}:{match['name']}"):
                    recognition.removed.append(removed)
            if similar := [f"`{name}`" for name, _ in nearest(match["name"], items)]:
                recognition.notes.append(
                    f"`{match['name']}` is not an item of this enum; closest: {', '.join(similar)}."
                )

    def _key(self, collection: str, name: str, query: str, recognition: Recognition) -> None:
        """A collection without such an element; it may be a socket's name in another version."""
        if collection == "bpy_prop_collection":
            recognition.notes.append(
                f'The collection has no element `{name}`; `.get("{name}")` returns None instead of an error.'
            )
        if recognition.removed or any(match.sure >= 0.9 for match in recognition.matches):
            return
        around = set(terms(query)) - set(terms(name))
        paths = [
            path
            for side in ("inputs", "outputs")
            for path in self._reader.removed_by_key(key(f'{side}["{name}"]'))
        ]
        paths.sort(key=lambda path: -len(around & set(terms(path.partition('puts["')[0]))))
        for path in paths[:1]:
            if removed := self._removed.of_path(path):
                recognition.removed.append(removed)

    # Removed data

    def _data(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.FREED, query):
            recognition.notes.append(
                "The variable's data was removed, freed, or moved by an undo or by adding another element: "
                "look it up again by name."
            )
            self._page(_ON_FREED, recognition)
            if match["module"]:
                recognition.add("bmesh.types.BMesh.free", 0.84, "error message")
                continue
            for entry in self._reader.members(f"{TYPES}BlendData").values():
                if entry.target == match["type"] and (
                    remove := self._resolver.member(TYPES + entry.collection, "remove")
                ):
                    recognition.add(remove.path, 0.84, "error message")
        for match in _matches(forms.NO_NODE_TYPE, query):
            if entry := self._reader.entry(TYPES + match["type"]):
                recognition.add(entry.path, 0.95, "error message")
            else:
                recognition.removed.extend(self._removed.spelled(match["type"]))

    def _page(self, slug: str, recognition: Recognition) -> None:
        if self._reader.page_entry(slug):
            recognition.add(slug, 0.86, "error message")
