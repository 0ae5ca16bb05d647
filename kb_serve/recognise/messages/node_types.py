"""Recognises messages of types of nodes that are undefined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.reader import TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.node_names import nodes_meant
from kb_serve.recognise.notes import SIMILAR
from kb_serve.recognise.recognition import MissingName

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed_symbols import RemovedSymbolLookup


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
                    self._like_nodes(match["type"], recognition)

    def _like_nodes(self, name: str, recognition: Recognition) -> None:
        """The nodes that a name which none has may mean."""
        for rank, path in enumerate(nodes_meant(name, self._reader)):
            recognition.add(path, 0.95 - 0.01 * rank, SIMILAR)
        recognition.missing.append(MissingName(name))
