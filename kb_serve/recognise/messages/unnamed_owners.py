"""Finds whose a member is that a message tells of without its class: of some collection, of a thing within."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, TYPES
from kb_serve.recognise.elsewhere.elements import elsewhere
from kb_serve.recognise.messages.absent import as_written

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.elsewhere.elements import Elsewhere
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_FEW = 3
_OWN = f"{COLLECTION}_idprop."  # the members of the collections of one's own
# What Python's lists or Blender's own collections call it → what a collection of one's own has for it, and how.
_ON_OWN = {
    "new": ("add", "`item = items.add()`"),
    "append": ("add", "`item = items.add()`"),
    "insert": ("add", "`items.add()`, then `items.move(len(items) - 1, index)`"),
    "extend": ("add", "`item = items.add()` for each"),
    "pop": ("remove", "`items.remove(index)`"),
    "delete": ("remove", "`items.remove(index)`"),
    "discard": ("remove", "`items.remove(index)`"),
    "unlink": ("remove", "`items.remove(index)`"),
    "index": ("find", '`items.find("name")`, which is -1 for none'),
    "sort": ("move", "`items.move(from_index, to_index)`"),
    "reverse": ("move", "`items.move(from_index, to_index)`"),
}
_REGISTERED = "bpy.props.CollectionProperty"
_IF_OWN = "If it is a `CollectionProperty` of your own: {how}."
_OF_ELEMENTS = (
    "Collections have no `{name}`, but what they hold has it, such as `{path}`: `{collection}[0].{called}`, or "
    "`for one in {collection}:` and `one.{called}`."
)
_ON_ELEMENTS = 0.93  # how sure what the elements of collections have by a name is
_ON_OTHERS = 0.86  # how sure what other collections have by a name is
_OWN_ALONE = 0.95  # how sure that is where no collection of Blender's has the name


class UnnamedOwners:
    """Finds owners of members against one base."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def of_a_collection(self, name: str, query: str, recognition: Recognition) -> None:
        """A member that a collection lacks: the one that lost it, and the collections that have it, weightiest first.

        Messages do not name a collection's own class; the code beside one may name the property that it is.
        """
        if other := self._done_elsewhere(name, query):
            recognition.add(other.path, 0.98, "error message")
            recognition.notes.append(other.how)
            return
        lost = [
            path for path in self._removed.paths_named(name) if path.rpartition(".")[0] in self._collections
        ]
        removed = self._removed.of_path(lost[0]) if len(lost) == 1 else None
        if removed and removed.gone:
            recognition.add_removed(removed)
        else:
            recognition.add(COLLECTION, 0.6, "error message")
        members = [
            entry for entry in self._reader.names.by_name(name) if entry.kind in {"property", "function"}
        ]
        having = self._reader.usage.heaviest(entry for entry in members if entry.owner in self._collections)
        for rank, entry in enumerate(having[:_FEW]):
            recognition.add(entry.path, _ON_OTHERS - 0.01 * rank, "same name")
        self._of_ones_own(name, recognition, sure=_ON_OTHERS - 0.005 if having else _OWN_ALONE)
        if having:
            listed = ", ".join(f"`{self._collections[entry.owner]}.{name}`" for entry in having[:_FEW])
            more = f" and {len(having) - _FEW} more" if len(having) > _FEW else ""
            recognition.notes.append(f"This collection has no `{name}`; others have: {listed}{more}.")
        elif not recognition.removed and name not in _ON_OWN:
            self._of_elements(name, members, query, recognition)

    def _of_elements(
        self, name: str, members: list[SymbolEntry], query: str, recognition: Recognition
    ) -> None:
        """A member that no collection has, but what collections hold, the weightiest of these.

        Of a collection that code names, another recogniser tells the same.
        """
        found = None if self._is_asked_of_one(name, query) else self._weightiest_elements(members)
        if found is None:
            return
        member, collection = found
        recognition.add(member.path, _ON_ELEMENTS, "error message")
        called = f"{name}(…)" if member.kind == "function" else name
        written = as_written(collection)
        recognition.notes.append(
            _OF_ELEMENTS.format(name=name, path=member.path, collection=written, called=called)
        )

    def _is_asked_of_one(self, name: str, query: str) -> bool:
        """Whether code asks it of a collection that the base knows: ``mesh.vertices.co``."""
        called = re.findall(rf"\.(\w+)\.{re.escape(name)}\b", query)[:_FEW]
        return any(
            entry.type == "collection" and self._reader.member_of(TYPES + entry.target, name)
            for one in called
            for entry in self._reader.names.by_name(one)
        )

    def _weightiest_elements(self, members: list[SymbolEntry]) -> tuple[SymbolEntry, str] | None:
        """The weightiest of some members that elements of a collection have, and that collection's path."""
        for member in self._reader.usage.heaviest(members)[:_FEW]:
            held = {entry.path for entry in self._reader.lineage(member.owner)}
            for cls, collection in self._elements.items():
                if cls in held or self._reader.descends(cls, member.owner):
                    return member, collection
        return None

    def _done_elsewhere(self, name: str, query: str) -> Elsewhere | None:
        """What adds or removes elements of the one collection that code asks for that: ``key_blocks.new("A")``."""
        for called in re.findall(rf"\.(\w+)\.{re.escape(name)}\b", query)[:_FEW]:
            entries = [entry for entry in self._reader.names.by_name(called) if entry.kind == "property"]
            found = {other for entry in entries if (other := elsewhere(entry.path, name, self._reader))}
            has_it = any(
                self._reader.member_of(entry.collection, name) for entry in entries if entry.collection
            )
            if len(found) == 1 and not has_it:
                return found.pop()
        return None

    def _of_ones_own(self, name: str, recognition: Recognition, *, sure: float) -> None:
        """What a collection that an add-on registers has for what was called."""
        if name not in _ON_OWN:
            return
        meant, how = _ON_OWN[name]
        recognition.notes.append(_IF_OWN.format(how=how))
        # Not every version's interface tells of the class.
        found = next(filter(self._reader.entry, (_OWN + meant, f"{COLLECTION}.{meant}")), _REGISTERED)
        recognition.add(found, sure, "error message")

    @cached_property
    def _elements(self) -> dict[str, str]:
        """Class of what collections hold → the weightiest property that is such a collection, weightiest first."""
        sql = "SELECT path, target FROM symbols WHERE type = 'collection' AND target != '' ORDER BY path"
        rows = self._reader.rows(sql)
        weights = self._reader.usage.weights([path for path, _ in rows])
        found: dict[str, str] = {}
        for path, cls in sorted(rows, key=lambda row: -weights.get(row[0], 0)):
            found.setdefault(TYPES + cls, path)
        return found

    @cached_property
    def _collections(self) -> dict[str, str]:
        """Class of collections → the weightiest property that is one: ``LayerObjects`` → ``ViewLayer.objects``."""
        sql = "SELECT path, collection FROM symbols WHERE target != '' AND collection != '' ORDER BY path"
        rows = self._reader.rows(sql)
        weights = self._reader.usage.weights([path for path, _ in rows])
        found: dict[str, str] = {}
        for path, cls in sorted(rows, key=lambda row: -weights.get(row[0], 0)):
            found.setdefault(TYPES + cls, path)
        return found
