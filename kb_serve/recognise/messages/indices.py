"""Explains messages of elements that a collection or an array does not have at an index."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, SIDES, TYPES
from kb_build.symbols.flag_names import EMPTY, EVALUATED
from kb_build.symbols.lines import GET_EVALUATED
from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_BMESH = "bmesh.types.BMesh"
_SEQUENCES = ("verts", "edges", "faces")
_ELEMENTS = (
    "`{name}` has {size} elements, each animated by itself: the index is 0 to {last}; without one all are."
)
_OF_NODES = (
    "The node has {size} {side}, counted from 0, and no script adds any to a node of Blender's own. Take them by their "
    "names, which other versions keep: `node.{side}.keys()`."
)
_ADD = ("new", "append", "add", "link")  # functions of collections


class Indices:
    """Finds in one base what adds elements to collections."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds how many elements there are, and what adds one to a collection."""
        for match in forms.first_matches(forms.NO_INDEX, query):
            recognition.notes.append(self._index(match["index"], int(match["size"]), query, recognition))
            recognition.add(COLLECTION, 0.81, "error message")
        for match in forms.first_matches(forms.NO_ELEMENT, query):
            recognition.notes.append(_ELEMENTS.format(last=int(match["size"]) - 1, **match.groupdict()))
        if forms.OUTDATED.search(query):
            self._outdated(query, recognition)

    def _outdated(self, query: str, recognition: Recognition) -> None:
        """What makes elements of a BMesh available by index, of the sequence that the code indexes, else of each."""
        members = self._reader.members(_BMESH)
        indexed = [name for name in _SEQUENCES if f".{name}[" in query]
        for rank, name in enumerate(indexed or _SEQUENCES):
            if entry := self._reader.member_of(members[name].type, "ensure_lookup_table"):
                recognition.add(entry.path, 0.98 - 0.01 * rank, "error message")
        written = (indexed or _SEQUENCES)[0]
        recognition.notes.append(
            f"Elements were added or removed since: `bm.{written}.ensure_lookup_table()`, then `bm.{written}[index]`."
        )

    def _index(self, index: str, size: int, query: str, recognition: Recognition) -> str:
        """How many elements a collection has that lacks one, and, where the query names it, what adds one."""
        held = f"only {size}, counted from 0" if size else "no elements"
        note = f"The collection has {held}: there is no `[{index}]` yet."
        subscripted = forms.SUBSCRIPTED.findall(query)
        if side := next((name for name in reversed(subscripted) if name in SIDES), ""):
            return _OF_NODES.format(size=size, side=side)
        found = {match.id for match in recognition.matches}
        for symbol in filter(None, map(self._reader.symbol, found)):
            if EVALUATED in symbol.flags and symbol.name in subscripted:
                return (
                    f"{note} Blender fills `.{symbol.name}` on evaluated objects only: `obj{GET_EVALUATED}`."
                )
        # Of ``vertices[0].groups[0]`` it is mostly the last that is empty.
        for name in reversed(subscripted):
            entries = [entry for entry in self._reader.names.by_name(name) if entry.type == "collection"]
            entries = [entry for entry in entries if entry.path in found] or entries
            if len({(entry.collection, entry.target) for entry in entries}) == 1:
                if told := self._either(entries[0], index, query):
                    return f"{note} {told}"
                functions = self._reader.members(f"{TYPES}{entries[0].collection}")
                adding = next((functions[one].path for one in _ADD if one in functions), "")
                if symbol := self._reader.symbol(adding):
                    return f"{note} {_added_by(name, symbol)}"
                made = self._reader.makers.creations([f"{TYPES}{entries[0].target}"]).values()
                return next((f"{note} `{creation.call}` adds one." for creation in made), note)
        return note

    def _either(self, last: SymbolEntry, index: str, query: str) -> str:
        """What adds an element to each of two collections, of which the code takes one by the same index, and the first
        is empty on new things: its elements have the last one. Empty where that is not so.
        """
        names = re.findall(rf"\b([a-z]\w*)\[{re.escape(index)}\]", query)
        before = names[names.index(last.name) - 1] if last.name in names[1:] else ""
        holders = (
            one
            for one in self._reader.names.by_name(before)
            if before and f"{TYPES}{one.target}" == last.owner
        )
        first = next(holders, None)
        held = self._reader.symbol(first.path) if first else None
        if first is None or held is None or EMPTY not in held.flags:
            return ""
        functions = [self._reader.symbol(f"{TYPES}{one.collection}.new") for one in (first, last)]
        told = [
            _added_by(one.name, new).rstrip(".")
            for one, new in zip((first, last), functions, strict=True)
            if new
        ]
        return f"It may be either: {' and '.join(told)}." if len(told) > 1 else ""


def _added_by(name: str, function: Symbol) -> str:
    """The call of a collection's function that adds an element, and the things whose collection refuses it."""
    given = ", ".join(parameter.name for parameter in function.parameters if parameter.required)
    told = f"`.{name}.{function.name}({given})` adds one"
    refusing = {(one.by, one.taken_by) for one in function.refusals if one.by and not one.values}
    if len(refusing) != 1:
        return f"{told}."
    ((by, taken_by),) = refusing
    return f"{told} to a {' or '.join(taken_by)}; a {' or '.join(by)} refuses it."
