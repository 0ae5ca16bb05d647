"""Explains messages of more arguments by place than there are, and of those that lack or must be given by name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.code.wrong_arguments import counted_arguments
from kb_serve.signatures import places_of

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.named_symbols import NamedSymbols
    from kb_serve.recognise.recognition import Recognition


_SEVERAL = re.compile(r"\[\d*\]|list|sequence")  # in the type of what takes several values


class ArgumentPlaces:
    """Finds in one base how functions take their arguments."""

    def __init__(self, reader: BaseReader, symbols: NamedSymbols) -> None:
        self._reader = reader
        self._symbols = symbols

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds the function, and how it is to be called."""
        for match in forms.first_matches(forms.TOO_MANY, query):
            self._too_many(match["function"], int(match["most"]), recognition)
        for match in forms.first_matches(forms.BY_NAME_ONLY, query):
            self._by_name(match["function"], match["name"], recognition)
        for match in forms.first_matches(forms.NO_SEQUENCE, query):
            self._several(match["function"], match["name"], recognition)

    def _too_many(self, function: str, most: int, recognition: Recognition) -> None:
        """More arguments than a function or class takes: what it takes, one sequence perhaps."""
        path = self._symbols.class_path(function) or self._symbols.function(function)
        symbol = self._reader.symbol(path) if path else None
        if symbol is None or not symbol.signature:
            return
        recognition.add(symbol.path, 0.95, "error message")
        if symbol.kind == "operator":
            recognition.notes.append(
                f"`{symbol.path}` takes its arguments by name only: `{symbol.signature}`."
            )
            return
        is_sequence = "=(" in symbol.signature.partition(",")[0]
        places = places_of(symbol)
        if places and len(places[0]) < most:
            told = f"takes {counted_arguments(len(places[0]))} by place: `{symbol.signature}`."
        elif is_sequence:
            told = f"takes at most {most} by position, the first a sequence: `{symbol.name}((…, …))`."
        else:
            told = f"takes {counted_arguments(most)}: `{symbol.signature}`."
        recognition.notes.append(f"`{symbol.path}` {told}")

    def _several(self, function: str, argument: str, recognition: Recognition) -> None:
        """An argument that takes several values, and was given one."""
        symbol = self._reader.symbol(self._symbols.function(function))
        parameter = next((one for one in symbol.parameters if one.name == argument), None) if symbol else None
        if symbol and parameter and _SEVERAL.search(parameter.type):
            recognition.add(symbol.path, 0.98, "error message")
            recognition.notes.append(f"`{argument}` of `{symbol.path}` takes several values, a list: `[…]`.")

    def _by_name(self, function: str, argument: str, recognition: Recognition) -> None:
        """An argument that a function needs, or takes by name only."""
        symbol = self._reader.symbol(self._symbols.function(function))
        if symbol is None:
            return
        recognition.add(symbol.path, 0.98, "error message")
        needed = any(one.name == argument and one.required for one in symbol.parameters)
        told = f"needs `{argument}`" if needed else f"takes `{argument}` by name only, as `{argument}=…`"
        recognition.notes.append(f"`{symbol.path}` {told}: `{symbol.signature}`.")
