"""Recognises messages of modules, and names in modules, that cannot be imported."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed_symbols import RemovedSymbolLookup


class Imports:
    """Finds what cannot be imported from one base's Blender."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what other versions had of it."""
        for match in forms.first_matches(forms.NO_MODULE, query):
            self.tell_if_gone(match["module"], recognition)
        for match in forms.first_matches(forms.NO_IMPORT, query):
            self.tell_if_gone(f"{match['module']}.{match['name']}", recognition)

    def tell_if_gone(self, path: str, recognition: Recognition) -> None:
        """Adds a module, or a name in one, that only other versions have."""
        if not self._reader.entry(path) and (removed := self._removed.of_path(path)):
            recognition.add_removed(removed)
