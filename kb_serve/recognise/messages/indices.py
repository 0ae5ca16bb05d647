"""Explains messages of elements that a collection or an array does not have at an index."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, TYPES
from kb_build.symbols.lines import GET_EVALUATED
from kb_build.symbols.records import EVALUATED
from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_BMESH = "bmesh.types.BMesh"
_SEQUENCES = ("verts", "edges", "faces")
_ELEMENTS = (
    "`{name}` has {size} elements, each animated by itself: the index is 0 to {last}; without one all are."
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
        found = {match.id for match in recognition.matches}
        for symbol in filter(None, map(self._reader.symbol, found)):
            if EVALUATED in symbol.flags and symbol.name in forms.SUBSCRIPTED.findall(query):
                return (
                    f"{note} Blender fills `.{symbol.name}` on evaluated objects only: `obj{GET_EVALUATED}`."
                )
        # Of ``vertices[0].groups[0]`` it is mostly the last that is empty.
        for name in reversed(forms.SUBSCRIPTED.findall(query)):
            entries = [entry for entry in self._reader.by_name(name) if entry.type == "collection"]
            entries = [entry for entry in entries if entry.path in found] or entries
            if len({(entry.collection, entry.target) for entry in entries}) == 1:
                functions = self._reader.members(f"{TYPES}{entries[0].collection}")
                adding = next((functions[one].path for one in _ADD if one in functions), "")
                if symbol := self._reader.symbol(adding):
                    return f"{note} {_added_by(name, symbol)}"
                made = self._reader.creations([f"{TYPES}{entries[0].target}"]).values()
                return next((f"{note} `{creation.call}` adds one." for creation in made), note)
        return note


def _added_by(name: str, function: Symbol) -> str:
    """The call of a collection's function that adds an element, and the things whose collection refuses it."""
    given = ", ".join(parameter.name for parameter in function.parameters if parameter.required)
    told = f"`.{name}.{function.name}({given})` adds one"
    refusing = {(one.by, one.taken_by) for one in function.refusals if one.by and not one.values}
    if len(refusing) != 1:
        return f"{told}."
    ((by, taken_by),) = refusing
    return f"{told} to a {' or '.join(taken_by)}; a {' or '.join(by)} refuses it."
