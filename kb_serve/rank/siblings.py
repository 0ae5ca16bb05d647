"""Finds what a question asks for beside what was found: ``spot light blend and cone angle`` wants two members of a
class, of which the search ranks one, and the other behind everything that is like the first.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kb_build.index.analysis import stem, stems_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_serve.rank.inverted_index import InvertedIndex
    from kb_serve.rank.ranked_id import RankedId
    from kb_serve.rank.scoring import Concept
    from kb_serve.reader import BaseReader, SymbolEntry

_ROWS = 5  # of what was found, the first, whose classes may have more
_CLASSES = 2
_MOST = 3
_READ = 6  # members of a class whose entries are read
_LITTLE = 1.0  # what a member says of a word, less of which is never in its name
_SAYS = 1.4  # what a member says of a word (see StemPostings) that its label may have
_ELSEWHERE = 0.3  # what such a word counts, next to one in its name
_MUCH, _SPOKEN = 1.9, 0.25  # what it says of a word that it speaks of much, and how much of that counts
_LEAST = 1.5  # idf of what a member tells that nothing else does
_SHARE = 0.3  # of what its names say, what counts of words that others say already
_UNASKED = 0.5  # what a word of its name takes away that nobody asked for
_COUNTS = 0.1
_KINDS = frozenset(
    map(stem, ("constraint", "data", "group", "modifier", "node", "object", "property", "settings", "strip"))
)  # by which classes are called, and questions seldom call them
_ENDS = (("min", "max"), ("start", "end"), ("x", "y"), ("left", "right"))
_OTHER_END = dict((pair for one, other in _ENDS for pair in ((one, other), (other, one))))


class _Class(NamedTuple):
    """A class, and those of its members that were found."""

    path: str
    found: list[SymbolEntry]


class _Member(NamedTuple):
    """A member of a class, and the words that it tells of, each with how much, up to 1."""

    entry: SymbolEntry
    told: dict[str, float]


class Siblings:
    """Finds them in one base."""

    def __init__(self, reader: BaseReader, index: InvertedIndex) -> None:
        self._reader = reader
        self._index = index
        self._topic = lru_cache(maxsize=64)(self._topic_of)

    def of(self, rows: Sequence[RankedId], concepts: Iterable[Concept], *, is_named: bool) -> list[str]:
        """Members of the first classes of what was found, in whose names or labels are words of the question that
        nothing of that class has which was found; and the other end of a range. Of one class, where the question names
        the best (``is_named``).
        """
        asked = {concept.stem: concept.idf for concept in concepts if concept.stem}
        first = rows[:_ROWS]
        known = {row.id for row in first} | {f"{row.id}.{name}" for row in first for name in row.members}
        likely = [
            (left, self._likely(cls.path, left, known))
            for cls in self._classes(first, asked)[: 1 if is_named else _CLASSES]
            if (left := _left(asked, (*stems_of(cls.path.rpartition(".")[2]), *_said_by(*cls.found))))
        ]
        self._reader.entry.load(self._index.levels[0].refs[number] for _, own in likely for number in own)
        chosen: list[SymbolEntry] = []
        for left, own in likely:
            chosen += self._saying(own, _left(left, _said_by(*chosen)), asked)
        chosen += self._other_end(first, known)
        return [entry.path for entry in chosen[:_MOST]]

    def _classes(self, rows: Sequence[RankedId], asked: Mapping[str, float]) -> list[_Class]:
        """The classes of what was found, those first that the question names."""
        classes: dict[str, _Class] = {}
        first = [row for row in rows if not self._reader.is_page(row.id)]
        members = [f"{row.id}.{name}" for row in first for name in row.members]
        self._reader.entry.load((*(row.id for row in first), *members))
        for path in (*(row.id for row in first), *members):
            entry = self._reader.entry(path)
            if entry is None or entry.kind == "operator":
                continue
            cls = entry.path if entry.kind == "class" else entry.owner
            if self._topic(cls) is not None:
                classes.setdefault(cls, _Class(cls, [])).found.append(entry)
        return sorted(classes.values(), key=lambda cls: not _is_named(cls.path, asked))

    def _topic_of(self, cls: str) -> int | None:
        """The number of a class among the topics; None if it is none."""
        try:
            return self._index.levels[1].refs.index(cls)
        except ValueError:
            return None

    def _saying(
        self, own: Mapping[int, Mapping[str, float]], left: dict[str, float], asked: Mapping[str, float]
    ) -> Iterator[SymbolEntry]:
        """Those of some members that say most of the words left, each what those before it do not."""
        near = self._members(own)
        while left:
            new = {number: _new(member, left) for number, member in near.items()}
            telling = [number for number in near if new[number] >= _LEAST]
            if not telling:
                return
            best = max(
                telling, key=lambda number: new[number] + self._beside(number, near[number], left, asked)
            )
            member = near.pop(best)
            yield member.entry
            left = _left(left, member.told)

    def _members(self, own: Mapping[int, Mapping[str, float]]) -> dict[int, _Member]:
        entries = {number: self._reader.entry(self._index.levels[0].refs[number]) for number in own}
        return {
            number: _Member(entry, _told(entry, own[number]))
            for number, entry in entries.items()
            if entry is not None and entry.kind != "class"
        }

    def _words_of(self, cls: str, wanted: Iterable[str]) -> dict[int, dict[str, float]]:
        """By the number of each member of a class which of some words it has, and how much it says of them."""
        members = (self._index.levels[0].topics == self._topic(cls)).nonzero()[0]
        found: dict[int, dict[str, float]] = {}
        for word in wanted:
            postings = self._index.postings(word)
            numbers = postings.numbers[: postings.units]
            places = np.searchsorted(numbers, members)
            places = places[numbers.take(places, mode="clip") == members]
            places = places[postings.saturated[places] >= _LITTLE]
            for number, says in zip(
                numbers[places].tolist(), postings.saturated[places].tolist(), strict=True
            ):
                found.setdefault(number, {})[word] = says
        return found

    def _likely(self, cls: str, left: Mapping[str, float], known: set[str]) -> dict[int, Mapping[str, float]]:
        """By number the members of a class, not known already, that are likeliest to tell of some words, and how much
        each has of them.
        """
        refs = self._index.levels[0].refs
        own = self._words_of(cls, left)

        def near(number: int) -> float:
            name = stems_of(refs[number].rpartition(".")[2])
            in_name = sum(left[word] for word in own[number] if word in name)
            elsewhere = sum(
                left[word] for word, says in own[number].items() if says >= _SAYS and word not in name
            )
            return in_name + _ELSEWHERE * elsewhere - _UNASKED * len(name)

        unknown = (number for number in own if refs[number] not in known)
        return {number: own[number] for number in sorted(unknown, key=near, reverse=True)[:_READ]}

    def _beside(
        self, number: int, member: _Member, left: Mapping[str, float], asked: Mapping[str, float]
    ) -> float:
        """What speaks for a member beside the words that it is looked for by."""
        again = sum(idf for word, idf in asked.items() if word in member.told and word not in left)
        unasked = len(stems_of(member.entry.name).difference(asked))
        return _SHARE * again - _UNASKED * unasked + _COUNTS * float(self._index.counts[number])

    def _other_end(self, rows: Sequence[RankedId], known: set[str]) -> Iterator[SymbolEntry]:
        """The other end of the range of which the first symbol is one: ``slider_max`` of ``slider_min``."""
        first = next((row.id for row in rows if not self._reader.is_page(row.id)), "")
        owner, _, name = first.rpartition(".")
        parts = name.split("_")
        for place, part in enumerate(parts):
            if part in _OTHER_END:
                other = "_".join((*parts[:place], _OTHER_END[part], *parts[place + 1 :]))
                entry = self._reader.entry(f"{owner}.{other}")
                if entry is not None and entry.path not in known:
                    yield entry


def _is_named(cls: str, asked: Mapping[str, float]) -> bool:
    """Whether a question says what makes a class's name."""
    name = stems_of(cls.rpartition(".")[2]) - _KINDS
    return bool(name) and name.issubset(asked)


def _left(words_asked: Mapping[str, float], said: Iterable[str]) -> dict[str, float]:
    told = frozenset(said)
    return {word: idf for word, idf in words_asked.items() if word not in told}


def _told(entry: SymbolEntry, own: Mapping[str, float]) -> dict[str, float]:
    """The words that a member's name and label have, and those that the rest of it speaks of much."""
    spoken = {word: _SPOKEN * says for word, says in own.items() if says >= _MUCH}
    return spoken | dict.fromkeys(_said_by(entry), 1.0)


def _new(member: _Member, left: Mapping[str, float]) -> float:
    """How much a member tells of some words."""
    return sum(left[word] * share for word, share in member.told.items() if word in left)


def _said_by(*entries: SymbolEntry) -> set[str]:
    """The stems of the names and labels of some symbols."""
    return {word for entry in entries for name in (entry.name, entry.label) for word in stems_of(name)}
