"""Finds the nodes that a question about nodes calls by their labels: ``image texture with mapping node``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.symbols.api_names import NODE, TYPES
from kb_serve.rank.asked_words import NODE_WORDS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_NO_LABEL = frozenset({"node", "nodes"})
_JOINS = _NO_LABEL | {"and"}
_MARKS = ".,:;?!()'\"`"
_OF_TEXTURES = f"{TYPES}TextureNode"
_SYSTEM = ("geometry", "nodes")  # which trees a question is of, no node called Geometry
_LONGEST = 4  # words of a label
_MOST_WORDS = 20  # with more of them it is no question about nodes alone


class NamedNode(NamedTuple):
    """The path of a node, and the places of the words of a question that are its label."""

    path: str
    start: int
    end: int


def named_nodes(question: str, reader: BaseReader) -> list[str]:
    """Paths of the nodes whose labels a question that speaks of nodes says, in its order: of each label the node that
    counts most, of old textures only where there is no other.
    """
    said = words_said(question)
    if len(said) > _MOST_WORDS or NODE_WORDS.isdisjoint(said):
        return []
    return list(dict.fromkeys(node.path for node in nodes_by_label(said, reader)))


def words_said(question: str) -> list[str]:
    """The words of a question, in small letters and without marks around them."""
    return [word.strip(_MARKS) for word in question.lower().split()]


def nodes_by_label(said: Sequence[str], reader: BaseReader) -> list[NamedNode]:
    """The nodes whose labels stand among words, in their order."""
    spans = [*_spans(said)]
    reader.names.by_key.load("".join(said[start:end]) for start, end in spans)
    nodes: list[NamedNode] = []
    for start, end in spans:
        is_free = not nodes or start >= nodes[-1].end
        if is_free and (node := _called("".join(said[start:end]), reader)):
            nodes.append(NamedNode(node, start, end))
    return nodes


def _spans(said: Sequence[str]) -> Iterator[tuple[int, int]]:
    """The places of words that may be a label, at each place the longest first; of single ones those that are joined
    to what a node is called by, as most labels of one word are words of any question.
    """
    for start in range(len(said)):
        for end in range(min(len(said), start + _LONGEST), start, -1):
            is_long = end - start > 1
            if tuple(said[start : end + 1]) == _SYSTEM:
                continue
            if _NO_LABEL.isdisjoint(said[start:end]) and (
                is_long or not _JOINS.isdisjoint(said[end : end + 1])
            ):
                yield start, end


def _called(label: str, reader: BaseReader) -> str:
    """The node with a label, in small letters and without spaces; empty for none."""
    paths = [path for _, path in reader.names.by_key(label)]
    reader.entry.load(paths)
    found = map(reader.entry, paths)
    nodes = [
        entry for entry in found if entry and _is_called(entry, label) and reader.descends(entry.path, NODE)
    ]
    if not nodes:
        return ""
    weights = reader.usage.weights([node.path for node in nodes])
    return max(nodes, key=lambda n: (not n.path.startswith(_OF_TEXTURES), weights.get(n.path, 0.0))).path


def _is_called(entry: SymbolEntry, label: str) -> bool:
    return entry.kind == "class" and key(entry.label) == label
