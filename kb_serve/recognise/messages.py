"""Blender's error messages in a query → what they are about, and what they mean there."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_serve.reader import TYPES
from kb_serve.recognise import message_forms as forms
from kb_serve.recognise.calls import NO_OVERRIDE, OVERRIDE, unknown_keywords
from kb_serve.recognise.corrections import nearest
from kb_serve.recognise.identified import Missing

if TYPE_CHECKING:
    from kb_serve.reader import Entry, Reader
    from kb_serve.recognise.corrections import Drift, Drifts
    from kb_serve.recognise.enum_values import EnumValues
    from kb_serve.recognise.identified import Identified
    from kb_serve.recognise.resolver import Walker

_FEW = 3
_MANY = 8  # places that may hold None: of more, none is likely enough to be named
# Pages of the API's own guides that explain a kind of message; named where the base has them.
_ON_OPERATORS = "info_gotchas_operators"
_ON_FREED = "info_gotchas_crashes"


class Messages:
    """Recognises error messages against one base."""

    def __init__(self, reader: Reader, walker: Walker, drifts: Drifts, enum_values: EnumValues) -> None:
        self._reader = reader
        self._walker = walker
        self._drifts = drifts
        self._enum_values = enum_values

    def recognise(self, query: str, found: Identified) -> None:
        """Adds what a message names: a class without an attribute, an operator, the owner of an enumeration."""
        self._attributes(query, found)
        self._operators(query, found)
        self._values(query, found)
        self._data(query, found)

    def explain(self, query: str, found: Identified) -> None:
        """Adds what can be said only once the query's names are known: the right argument, a former socket."""
        for match in forms.BAD_KEYWORD.finditer(query):
            self._keyword(match["name"], found)
        for match in forms.NO_KEY.finditer(query):
            self._key(match["on"], match["name"], query, found)

    # Attributes

    def _attributes(self, query: str, found: Identified) -> None:
        for pattern in (forms.HAS_NO, forms.MODULE_HAS_NO):
            for match in pattern.finditer(query):
                if match["owner"] == "NoneType":
                    self._none(match["name"], query, found)
                    continue
                owner = self._class_path(match["owner"])
                if former := self._former_owner(match["owner"], match["name"], owner):
                    found.drifts.extend(former)
                elif owner and not self._walker.member(owner, match["name"]):
                    found.missing.append(Missing(match["name"], owner))
                    found.add(owner, 0.6, "error message")
        for match in forms.READ_ONLY.finditer(query):
            owner = "bpy.context" if match["context"] else TYPES + match["owner"]
            entry = self._named(owner, match["context"] or match["name"])
            if entry:
                found.add(entry.path, 0.98, "error message")
                found.said.append(f"`{entry.path}` can be read, not assigned.")
        for match in forms.WRONG_TYPE.finditer(query):
            if match["path"] and (entry := self._named(*match["path"].rpartition(".")[::2])):
                found.add(entry.path, 0.98, "error message")

    def _none(self, name: str, query: str, found: Identified) -> None:
        """What may be None where ``.name`` was asked of it: the pointers to classes that have the name."""
        found.said.append(f"What stands before `.{name}` is None: it does not exist (yet), or was not found.")
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
        told = [entry for entry in holders if set(terms(f"{entry.owner} {entry.name}")) <= around | {"type"}]
        if len(owners) <= _FEW and len(holders) <= _MANY:
            told = told or holders
        for rank, entry in enumerate(told[:_FEW]):
            found.add(entry.path, 0.86 - 0.01 * rank, "may be None")
            found.add(f"{TYPES}{entry.target}.{name}", 0.81 - 0.01 * rank, "asked of None")

    def _is_never_none(self, entry: Entry) -> bool:
        symbol = self._reader.symbol(entry.path)
        return symbol is not None and "never-none" in symbol.flags

    def _former_owner(self, written: str, name: str, owner: str) -> list[Drift]:
        """The members, or else the classes, that other versions had under a name that is not a class here."""
        if self._reader.entry(TYPES + written):
            return []
        members = [*self._drifts.spelled(f"{written}.{name}")]
        return members if members or owner else [*self._drifts.spelled(written)]

    def _class_path(self, name: str) -> str:
        for candidate in (TYPES + name, name):
            if self._reader.entry(candidate):
                return candidate
        for _, identifier in self._reader.by_key(key(name)):
            entry = self._reader.entry(identifier)
            if entry and entry.kind in {"class", "module"}:
                return identifier
        return ""

    def _named(self, owner: str, name: str) -> Entry | None:
        cls = self._class_path(owner)
        return (self._walker.member(cls, name) or self._reader.entry(f"{cls}.{name}")) if cls else None

    # Operators

    def _operators(self, query: str, found: Identified) -> None:
        for match in forms.POLL.finditer(query):
            if self._reader.entry(match["path"]):
                found.add(match["path"], 0.98, "error message")
                found.said.append(
                    f"`{match['path']}.poll()` refuses: the operator wants another mode, active object, selection "
                    f"or editor than the context has. `{OVERRIDE}` gives it one."
                )
                self._page(_ON_OPERATORS, found)
                found.add(OVERRIDE, 0.82, "error message")
        for match in forms.WRONG_TYPE.finditer(query):
            if match["operator"]:
                module, _, name = match["operator"].partition("_OT_")
                if entry := self._reader.entry(f"bpy.ops.{module.lower()}.{name}"):
                    found.add(entry.path, 0.98, "error message")
        if forms.POSITIONAL.search(query):
            found.said.append(NO_OVERRIDE)
            found.add(OVERRIDE, 0.9, "error message")
            self._page(_ON_OPERATORS, found)
        for match in forms.NOT_AN_OPERATOR.finditer(query):
            names = self._reader.members("bpy.ops").keys() | self._reader.members("bmesh.ops").keys()
            for name, alike in nearest(match["name"], names, _FEW):
                if entry := self._reader.entry(f"bmesh.ops.{name}"):
                    found.add(entry.path, max(0.82, 0.95 * alike), "similar name")
            found.said.append(f"`bmesh.ops` has no `{match['name']}`.")

    def _keyword(self, name: str, found: Identified) -> None:
        """The arguments that a call has, in place of one that it has not."""
        for match in sorted(found.matches, key=lambda match: -match.sure):
            symbol = self._reader.symbol(match.id)
            if symbol is not None and symbol.parameters:
                found.said += unknown_keywords(symbol, [name])
                return

    # Values

    def _values(self, query: str, found: Identified) -> None:
        for match in forms.BAD_ENUM.finditer(query):
            items = re.findall(r"'([^']+)'", match["items"])
            for rank, (owner, _) in enumerate(self._enum_values.owners(items)):
                if rank >= 2:
                    break
                path = owner.partition("(")[0]
                found.add(path, 0.95 - 0.02 * rank, "error message")
                if drift := self._drifts.of_path(f"{path}:{match['name']}"):
                    found.drifts.append(drift)
            if similar := [f"`{name}`" for name, _ in nearest(match["name"], items)]:
                found.said.append(f"`{match['name']}` is no item here; closest: {', '.join(similar)}.")

    def _key(self, collection: str, name: str, query: str, found: Identified) -> None:
        """A collection has no such element; what was a socket's name in another version is likely that."""
        if collection == "bpy_prop_collection":
            found.said.append(f'The collection has no element `{name}`; `.get("{name}")` would give None.')
        if found.drifts or any(match.sure >= 0.9 for match in found.matches):
            return
        around = set(terms(query)) - set(terms(name))
        paths = [
            path
            for side in ("inputs", "outputs")
            for path in self._reader.removed_by_key(key(f'{side}["{name}"]'))
        ]
        paths.sort(key=lambda path: -len(around & set(terms(path.partition('puts["')[0]))))
        for path in paths[:1]:
            if drift := self._drifts.of_path(path):
                found.drifts.append(drift)

    # Data that is gone

    def _data(self, query: str, found: Identified) -> None:
        for match in forms.FREED.finditer(query):
            found.said.append(
                "The variable outlived its data, which was removed or freed, or moved by an undo or by another "
                "element's adding: look it up again, by name."
            )
            self._page(_ON_FREED, found)
            if match["module"]:
                found.add("bmesh.types.BMesh.free", 0.84, "error message")
                continue
            for entry in self._reader.members(f"{TYPES}BlendData").values():
                if entry.target == match["type"] and (
                    remove := self._walker.member(TYPES + entry.collection, "remove")
                ):
                    found.add(remove.path, 0.84, "error message")
        for match in forms.NO_NODE_TYPE.finditer(query):
            if entry := self._reader.entry(TYPES + match["type"]):
                found.add(entry.path, 0.95, "error message")
            else:
                found.drifts.extend(self._drifts.spelled(match["type"]))

    def _page(self, slug: str, found: Identified) -> None:
        if self._reader.page_entry(slug):
            found.add(slug, 0.86, "error message")
