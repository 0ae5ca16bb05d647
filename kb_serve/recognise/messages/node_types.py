"""Recognises messages of types of nodes that are undefined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.names.node_names import add_nodes_meant

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_MEANT = 0.95  # how sure a node is that an undefined type may mean


class NodeTypes:
    """Finds in one base the nodes that a type may mean."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the node of that name, the one that it was in another version, or those most like it."""
        for match in forms.first_matches(forms.NO_NODE_TYPE, query):
            if entry := self._reader.entry(TYPES + match["type"]):
                recognition.add(entry.path, 0.95, "error message")
            else:
                for removed in self._removed.spelled(match["type"]):
                    recognition.add_removed(removed)
                if not recognition.removed:
                    add_nodes_meant(match["type"], _MEANT, self._reader, recognition)
