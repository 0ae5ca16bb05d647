"""Adds the sockets that a question asks of a node which it calls by its label: ``Principled BSDF specular input``."""

from __future__ import annotations

from itertools import combinations, product
from typing import TYPE_CHECKING

from kb_build.index.analysis import STOP_WORDS, key
from kb_build.symbols.api_names import SIDES
from kb_build.symbols.paths import plain_path
from kb_serve.rank.nodes.named_nodes import nodes_by_label, words_said
from kb_serve.recognise.by_words.members_by_words import SIDE_WORDS, sockets_by_words
from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.rank.nodes.named_nodes import NamedNode
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_SURE = 0.9  # how sure a socket is meant whose name is said beside its node's
_SUCCESSOR = 0.95
_LATER = 0.005
_MOST_WORDS = 12  # with more of them it is a question about more than a socket
_LONGEST = 3  # words of a socket's former name
_NO_NAMES = STOP_WORDS | {"called", "default", "list", "name", "names", "node", "value"}


class AskedSockets:
    """Finds in one base the sockets that questions ask of nodes."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._removed = RemovedSymbolLookup(reader)

    def add(self, question: str, recognition: Recognition) -> None:
        """Adds the sockets of the one node that a question calls by its label, where it speaks of inputs or outputs:
        those that its other words name, and what took the place of one that was removed.
        """
        said = words_said(question)
        sides = {SIDE_WORDS[word] for word in said if word in SIDE_WORDS}
        best = recognition.best
        if not sides or len(said) > _MOST_WORDS or (best is not None and best.sure >= _SURE):
            return
        nodes = [node for node in nodes_by_label(said, self._reader) if not _is_of_list(node, said)]
        if len(nodes) != 1:  # who names several asks how they are linked
            return
        node = nodes[0]
        rest = [*said[: node.start], *said[node.end :]]
        asked = [word for word in rest if word not in SIDE_WORDS and word not in _NO_NAMES]
        if any(self._add_removed(path, recognition) for path in self._former(node.path, sides, asked)):
            return
        for rank, path in enumerate(sockets_by_words(node.path, sides, asked, self._reader)):
            recognition.add(path, _SURE - _LATER * rank, "class and words")

    def _add_removed(self, path: str, recognition: Recognition) -> bool:
        """Adds a removed socket with what took its place; whether it was one."""
        removed = self._removed.of_path(path)
        if removed is None:
            return False
        recognition.add_removed(removed)
        for rank, target in enumerate(removed.targets):
            recognition.add(plain_path(target), _SUCCESSOR - _LATER * rank, "successor")
        return True

    def _former(self, node: str, sides: set[str], asked: Sequence[str]) -> Iterator[str]:
        """Paths of the sockets that a node had, and that words are the name of."""
        spans = [span for span in combinations(range(len(asked) + 1), 2) if span[1] - span[0] <= _LONGEST]
        for side, (start, end) in product([*filter(None, sides)] or SIDES, spans):
            name = key(f"{side}[{''.join(asked[start:end])}]")
            yield from (
                path for path in self._reader.history.removed_by_key(name) if path.startswith(f"{node}.")
            )


def _is_of_list(node: NamedNode, said: Sequence[str]) -> bool:
    """Whether one word with an ``and`` behind it is taken for a node, ``scale and rotation``, that names a socket."""
    return node.end - node.start == 1 and said[node.end : node.end + 1] == ["and"]
