"""How surely the members of a class are called by the words of a question: all of a name's words, near each other."""

from __future__ import annotations

import re
from collections import defaultdict
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import terms
from kb_build.schema import Mark
from kb_build.symbols.api_names import ID, STRUCT
from kb_build.symbols.paths import socket_side

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_serve.reader import BaseReader

_MOST_KEPT = 100  # classes, of which a question looks at a few
_FARTHEST = 5  # words of a question between those of one name
_APART = 0.3  # what each of these takes from what the name counts
_AS_WRITTEN = 1.0  # what it adds that a name of several words stands in the question as code has it
_WORD_AS_WRITTEN = 0.2  # … or one of one word
_READ_ONLY = 0.5  # what it takes that a property cannot be set
_OTHER_ORDER = 0.5  # … that the words stand in another order
_UNSAID = 1.1  # … and each word of the name that only the label does without
_LEAST = -0.5  # what a name counts at least
KINDS = frozenset({"property", "function", "socket"})
# What begins the names of switches, which nobody says.
OF_SWITCHES = frozenset({"has", "is", "show", "use"})
_FIXED, _DEPRECATED = int(Mark.READ_ONLY), int(Mark.DEPRECATED)
_HELD = frozenset({"collection", "pointer"})  # which no script sets anyway
# The type of a socket → how a question calls it.
_SOCKET_TYPES = {
    "boolean": ("boolean",),
    "int": ("integer", "int"),
    "matrix": ("matrix",),
    "rgba": ("color",),
    "rotation": ("rotation",),
    "string": ("string",),
    "value": ("float",),
    "vector": ("vector",),
}
_SIDES = {"input": "inputs", "output": "outputs"}  # as their stems
_MACHINERY = ("bl_rna", "rna_")
_Row = tuple[str, str, str, str, str, int]  # path, kind, type, name, label, marks
_SHORT = 3  # letters of words that are their own stems
_TOKEN = re.compile(r"\w+")


class AskedWords(NamedTuple):
    """What a question says: the places of its words (stems), and its words and names as they are written."""

    places: Mapping[str, Sequence[int]]
    sides: frozenset[str]  # of nodes
    written: frozenset[str]
    beginnings: Sequence[str]


class CalledMember(NamedTuple):
    """A member that a question calls by some words, and how surely.

    ``is_name``: whether a word of it is the name as it is written; ``is_written``: whether that has several words.
    """

    path: str
    words: frozenset[str]
    counts: float
    is_name: bool = False
    is_written: bool = False


class _Member(NamedTuple):
    """A member of a class, with the words by which it may be asked for: those of its name, and those of its label.

    ``short`` is what its name is but for what begins those of switches; of a socket the label, in small letters.
    """

    path: str
    name: str
    short: str
    is_fixed: bool
    is_deprecated: bool
    side: str  # of a socket
    called: tuple[tuple[str, ...], ...]


class CalledMembers:
    """Finds what questions call by its name or label among the members of one base's classes."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._members = lru_cache(maxsize=_MOST_KEPT)(self._read_members)

    def of(self, cls: str, asked: AskedWords) -> Iterator[tuple[CalledMember, bool]]:
        """The members of a class that a question calls by all words of their names or labels, and whether they are the
        class's own; of one that is called by both, by its name. Sockets are called by their types and sides as well.
        """
        seen: set[str] = set()
        for owner, row in self._like(cls, asked.beginnings):
            member = _member(row)
            fits = filter(None, (_called(member, own, asked) for own in member.called))
            called = max(fits, key=lambda one: one.counts, default=None) if member.side else next(fits, None)
            name = member.path[len(owner) :]
            if called is not None and name not in seen:
                seen.add(name)
                yield called, owner == cls

    def having(self, cls: str, word: str) -> list[str]:
        """Paths of the members of a class that have a word (a stem) in their name or label."""
        members = (_member(row) for _, row in self._like(cls, _beginnings([word])))
        return [one.path for one in members if any(word in own for own in one.called)]

    def _like(self, cls: str, beginnings: Sequence[str]) -> Iterator[tuple[str, _Row]]:
        """(class, row) of the members of a class in whose names or labels something begins so: its own, and those of
        its bases that not everything has.
        """
        for ancestor in self._reader.lineage(cls):
            if ancestor.path == cls or ancestor.path not in {ID, STRUCT}:
                rows, texts, text = self._members(ancestor.path)
                there = [beginning for beginning in beginnings if beginning in text]
                for row, own in zip(rows, texts, strict=True) if there else ():
                    for beginning in there:
                        if beginning in own:
                            yield ancestor.path, row
                            break

    def _read_members(self, cls: str) -> tuple[list[_Row], list[str], str]:
        """The members of a class itself, with what they are called by in small letters, each and together: to take the
        words of all apart would cost more than to look through these.
        """
        sql = """SELECT path, kind, type, name, label, marks FROM symbols WHERE owner = ? AND grp != 'ui'
            AND kind IN ('property', 'function', 'socket') ORDER BY id"""
        rows = [row for row in self._reader.rows(sql, cls) if not row[3].startswith(_MACHINERY)]
        texts = [*map(_text, rows)]
        return rows, texts, "\n".join(texts)


def _text(row: _Row) -> str:
    """What has all words by which a member may be called."""
    path, kind, held, name, label, _ = row
    more = (*_SOCKET_TYPES.get(held, ()), socket_side(path)) if kind == "socket" else ()
    return " ".join((name, label, *more)).lower()


@lru_cache(maxsize=1_000)
def _member(row: _Row) -> _Member:
    path, kind, held, name, label, marks = row
    is_socket = kind == "socket"
    begin, _, rest = name.partition("_")
    short = label.lower() if is_socket else rest if begin in OF_SWITCHES else name
    is_fixed = kind == "property" and held not in _HELD and bool(marks & _FIXED)
    side = socket_side(path) if is_socket else ""
    texts = (
        (label, *(f"{kind} {side}" for kind in _SOCKET_TYPES.get(held, ()))) if is_socket else (name, label)
    )
    called = dict.fromkeys(filter(None, (tuple(terms(text)) for text in texts)))
    return _Member(path, name, short, is_fixed, bool(marks & _DEPRECATED), side, tuple(called))


def _beginnings(stems: Iterable[str]) -> tuple[str, ...]:
    """What the texts have that may have a word of some stems: these end otherwise than the words do."""
    return tuple(stem[:-1] if len(stem) > _SHORT else stem for stem in stems)


def read_question(question: str, stems: Sequence[str]) -> AskedWords:
    """The words of a question; ``stems`` are those that ask for something, in their order."""
    places: dict[str, list[int]] = defaultdict(list)
    for place, word in enumerate(stems):
        places[word].append(place)
    written = frozenset((*_TOKEN.findall(question), *_TOKEN.findall(question.lower())))
    sides = frozenset(side for word, side in _SIDES.items() if word in places)
    return AskedWords(places, sides, written, _beginnings(places))


def _called(member: _Member, called: Sequence[str], asked: AskedWords) -> CalledMember | None:
    """The member, if a question calls it by some words."""
    places = asked.places
    if member.side and asked.sides and member.side not in asked.sides:
        return None
    said = [word for word in called if word in places or word not in OF_SWITCHES]
    if not said or not all(word in places for word in said):
        return None
    between, in_order = _between([places[word] for word in said]) if len(said) > 1 else (0, True)
    unsaid = sum(word not in places and word not in OF_SWITCHES for word in member.called[0])
    counts = len(said) - _APART * between - _UNSAID * unsaid
    counts -= _READ_ONLY * member.is_fixed + _OTHER_ORDER * (not in_order)
    if between > _FARTHEST or counts < _LEAST:
        return None
    is_name = member.name in asked.written
    is_written = is_name and "_" in member.name
    if member.is_deprecated and not is_written:
        return None
    counts += _AS_WRITTEN if is_written else _WORD_AS_WRITTEN if is_name else 0.0
    is_name = is_name or member.short in asked.written
    return CalledMember(member.path, frozenset(said), counts, is_name, is_written)


def _between(places: Sequence[Sequence[int]]) -> tuple[int, bool]:
    """How many words stand between those with some places, where they are nearest to each other, and whether they stand
    in their order there.
    """
    found: list[tuple[int, bool]] = []
    for start in places[0]:
        near = [min(own, key=lambda place, start=start: abs(place - start)) for own in places]
        found.append((max(0, max(near) - min(near) + 1 - len(places)), near == sorted(near)))
    return min(found, key=lambda one: (one[0], not one[1]))
