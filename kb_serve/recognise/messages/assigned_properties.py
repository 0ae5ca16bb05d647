"""Recognises messages of properties that cannot be assigned: at all, or not with a value of that type."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.lines import locked_text
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.changed_by import changed_by

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.named_symbols import NamedSymbols
    from kb_serve.recognise.recognition import Recognition


class AssignedProperties:
    """Finds in one base the properties that were assigned."""

    def __init__(self, reader: BaseReader, symbols: NamedSymbols) -> None:
        self._reader = reader
        self._symbols = symbols

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the property, and what changes it, where that is known."""
        for match in forms.first_matches(forms.READ_ONLY, query):
            of_class = match["owner"] or match["array_owner"] or match["python_owner"]
            owner = "bpy.context" if match["context"] else of_class
            name = match["context"] or match["name"] or match["array"] or match["of_python"]
            if entry := self._symbols.member(owner, name):
                self._read_only(entry.path, recognition)
        for match in forms.first_matches(forms.WRONG_TYPE, query):
            if match["path"] and (entry := self._symbols.member(*match["path"].rpartition(".")[::2])):
                recognition.add(entry.path, 0.98, "error message")

    def _read_only(self, path: str, recognition: Recognition) -> None:
        """A property that cannot be assigned, and what changes it, where that is known."""
        recognition.add(path, 0.98, "error message")
        recognition.notes.append(self._locked(path))
        changer, how = changed_by(path)
        if changer and self._reader.entry(changer):
            recognition.add(changer, 0.97, "error message")
            recognition.notes.append(how)

    def _locked(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        if symbol is None or symbol.kind != "property" or READ_ONLY in symbol.flags:
            return f"`{path}` is read-only: it cannot be assigned."
        if text := locked_text(symbol):
            return f"`{path}` {text}."
        return f"`{path}` can be assigned at other times: another setting, or what it belongs to, decides it here."
