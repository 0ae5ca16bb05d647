"""Recognises messages of classes that were called with other arguments than they take."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.named_symbols import NamedSymbols
    from kb_serve.recognise.recognition import Recognition

_DRAWS = "GPU"  # what some messages leave out of a class's name: ``IndexBuf.__new__``


class CalledClasses:
    """Finds in one base the classes, and how they are called."""

    def __init__(self, reader: BaseReader, symbols: NamedSymbols) -> None:
        self._reader = reader
        self._symbols = symbols

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds each class of Blender's that a message says was called."""
        for match in forms.first_matches(forms.OF_MAKING, query):
            if symbol := self._called(match["class"]):
                recognition.add(symbol.path, 0.98, "error message")
                recognition.notes.append(f"`{symbol.path}` is called as `{symbol.signature}`.")

    def _called(self, name: str) -> Symbol | None:
        paths = (self._symbols.class_path(written, or_module=False) for written in (name, _DRAWS + name))
        symbols = (self._reader.symbol(path) for path in paths if path)
        return next((symbol for symbol in symbols if symbol and symbol.signature), None)
