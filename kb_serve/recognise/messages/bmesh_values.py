"""Recognises messages of values that an operator of ``bmesh.ops`` does not take."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_ELEMENTS = "bmesh sequence"  # what a message calls vertices, edges and faces


class BMeshValues:
    """Finds in one base what such an operator takes."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the operator, and what to give."""
        for match in forms.first_matches(forms.OF_BMESH, query):
            symbol = self._reader.symbol(f"bmesh.ops.{match['function']}")
            if symbol is None:
                continue
            recognition.add(symbol.path, 0.98, "error message")
            parameter = next((one for one in symbol.parameters if one.name == match["name"]), None)
            items = ", ".join(f"`{item.identifier!r}`" for item in parameter.enum_items) if parameter else ""
            if items:
                takes = f"one of {items}"
            elif _ELEMENTS in match["wanted"]:
                takes = "a list of the bmesh's own elements, as `bm.faces[:]`"
            else:
                takes = match["wanted"]
            recognition.notes.append(f"`{symbol.path}({match['name']}=…)` takes {takes}.")
