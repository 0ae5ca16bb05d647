"""Recognises messages of types of nodes that are undefined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.messages.of_older import of_older
from kb_serve.recognise.named.node_names import add_nodes_meant, same_in_tree, tree_of_family

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_MEANT = 0.95  # how sure a node is that an undefined type may mean
_INSTEAD = 0.97  # … that is of the same name in another family


class NodeTypes:
    """Finds in one base the nodes that a type may mean."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the node of that name, the one that it was in another version, or those most like it."""
        for match in forms.first_matches(forms.NO_NODE_TYPE, query):
            if symbol := self._reader.symbol(TYPES + match["type"]):
                recognition.add(symbol.path, _MEANT, "error message")
                if not symbol.trees:
                    self._tell_of_no_tree(symbol.name, recognition)
                elif note := of_older(symbol.path, self._reader):
                    recognition.notes.append(note)
            else:
                for removed in self._removed.spelled(match["type"]):
                    recognition.add_removed(removed)
                if not recognition.removed:
                    add_nodes_meant(match["type"], _MEANT, self._reader, recognition)
        for match in forms.first_matches(forms.NO_NODE_OF_TREE, query):
            if symbol := self._reader.symbol(TYPES + match["type"]):
                recognition.add(symbol.path, _MEANT, "error message")
                trees = " or ".join(f"a `{tree}`" for tree in symbol.trees)
                recognition.notes.append(f"`{match['type']}` is a node of {trees}: other trees refuse it.")

    def _tell_of_no_tree(self, name: str, recognition: Recognition) -> None:
        """Adds what the trees of its family take instead of a class of nodes that none takes."""
        others = same_in_tree(name, tree_of_family(name), self._reader.symbol)
        instead = f" Use {' or '.join(f'`{other}`' for other in others)}." if others else ""
        recognition.notes.append(f"`{TYPES}{name}` is a class of nodes that no tree takes.{instead}")
        for other in others:
            recognition.add(other, _INSTEAD, "error message")
