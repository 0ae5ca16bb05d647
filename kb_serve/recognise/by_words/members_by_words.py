"""Finds the members of a class that words beside its name describe: ``ParticleSettings brownian``."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from kb_build.index.analysis import STOP_WORDS, stem, words
from kb_build.symbols.api_names import NODE, SIDES, TYPES

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_MOST_WORDS = 5  # with more of them it is a question, in which the class is one word of many
_MOST_FOUND = 3  # more members than these are not told apart
_MOST_SOCKETS = 8  # … and sockets, of which a panel's worth begins alike: ``Coat Weight``, ``Coat Roughness``
_SHORTEST = 4  # letters of a word that may be a beginning, or misspelt
_MOST_COMPARED = 4_000  # pairs of words whose likeness is remembered
# How a question says that it is about sockets → the side that it means; empty for both.
SIDE_WORDS = {
    "input": "inputs", "inputs": "inputs", "output": "outputs", "outputs": "outputs", "socket": "", "sockets": "",
}  # fmt: skip
_SLIP = 0.79  # similarity of a word with two letters exchanged


def members_by_words(cls: str, beside: Collection[str], reader: BaseReader) -> list[str]:
    """Paths of the members of a class, or of what a member leads to, that all of some words describe; best first. Of a
    node also the sockets that they name one by one.

    Empty where too many do.
    """
    asked = [word for text in beside for word in words(text) if word not in STOP_WORDS]
    if not 0 < len(asked) <= _MOST_WORDS:
        return []
    if reader.descends(cls, NODE) and (sides := [word for word in asked if word in SIDE_WORDS]):
        named = [word for word in asked if word not in SIDE_WORDS]
        if named or not any(SIDE_WORDS[word] for word in sides):  # of ``sockets`` alone the class lists all
            return sockets_by_words(cls, {SIDE_WORDS[word] for word in sides}, named, reader)
    own = list(_members(cls, reader))
    found = [(_unsaid(entry, asked), entry.path) for entry in own if not _missing(entry, asked)]
    if not found:
        for pointer in own:
            rest = _missing(pointer, asked) if pointer.target else asked
            if 0 < len(rest) < len(asked):
                further = _members(TYPES + pointer.target, reader)
                found += [(_unsaid(one, rest), one.path) for one in further if not _missing(one, rest)]
    paths = list(dict.fromkeys(path for _, path in sorted(found, key=lambda row: row[0])))
    most = _MOST_SOCKETS if all("[" in path for path in paths) else _MOST_FOUND
    return paths if len(paths) <= most else []


def sockets_by_words(
    node: str, sides: Collection[str], asked: Collection[str], reader: BaseReader
) -> list[str]:
    """Paths of a node's sockets of some sides that words describe, all of them or else each of them one; without words
    none, as the node lists them all.
    """
    begins = tuple(f"{side}[" for side in [*filter(None, sides)] or SIDES)
    own = [one for name, one in reader.members(node).items() if name.startswith(begins)]
    found = [one.path for one in own if asked and not _missing(one, asked)]
    if not found:
        named = [[one.path for one in own if not _missing(one, [word])] for word in asked]
        found = [path for paths in named for path in paths] if all(named) else []
    return list(dict.fromkeys(found))[:_MOST_SOCKETS]


def _members(cls: str, reader: BaseReader) -> Iterator[SymbolEntry]:
    for ancestor in reader.lineage(cls):
        if not ancestor.name.startswith("bpy_"):
            yield from reader.members(ancestor.path).values()


def _missing(entry: SymbolEntry, asked: Collection[str]) -> list[str]:
    """The words that a member's name and label do not have."""
    said = {*words(entry.name), *words(entry.label)}
    return [word for word in asked if not any(_means(word, other) for other in said)]


def _unsaid(entry: SymbolEntry, asked: Collection[str]) -> int:
    """How many words of a member's name nobody asked for."""
    return sum(not any(_means(word, other) for word in asked) for other in words(entry.name))


@lru_cache(maxsize=_MOST_COMPARED)
def _means(word: str, other: str) -> bool:
    """Whether a word is another one, its beginning, or it with a slip of the fingers."""
    if word == other or stem(word) == stem(other):
        return True
    if len(word) < _SHORTEST:
        return False
    from rapidfuzz.distance import OSA  # noqa: PLC0415 - most words are spelled right

    return other.startswith(word) or (word[0] == other[0] and OSA.normalized_similarity(word, other) >= _SLIP)
