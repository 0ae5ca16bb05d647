"""The words of a query as the base knows them: by their stems, spelled right, class names taken apart."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from kb_build.index.analysis import STOP_WORDS, stem, words
from kb_serve.rank.scoring import Concept

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.rank.inverted_index import InvertedIndex
    from kb_serve.reader import BaseReader

_UNKNOWN_IDF = 6.0
_CORRECTED_WEIGHT = 0.95  # what a corrected word counts, next to one that was written so
_JOINED = 8  # letters of the shortest name of a class that is looked up as one word
_RARE = 20  # units that have a word which may be such a name
_AROUND = 0.4  # what a word around the query counts, next to one of it
_TWO_TYPOS = 9  # letters from which on two may be wrong
_MAX_WORDS = 40


class QueryWords:
    """Reads queries with the words of one base."""

    def __init__(self, reader: BaseReader, index: InvertedIndex) -> None:
        self._reader = reader
        self._index = index
        self.concepts = lru_cache(maxsize=8)(self._concepts)  # a query's are asked for more than once

    def around(self, about: str, text: str) -> Iterator[Concept]:
        """The words around a text that it does not have itself."""
        if about:
            own = set(map(stem, words(text)))
            for concept in self.concepts(about):
                if concept.stem not in own:
                    yield replace(concept, weight=_AROUND * concept.weight)

    @cached_property
    def _spellings(self) -> list[str]:
        """The most used spelling of each stem that is long enough to be misspelt."""
        sql = "SELECT word FROM vocabulary WHERE length(word) > 3 GROUP BY word ORDER BY min(stem)"
        return [word for (word,) in self._reader.rows(sql)]

    def correction(self, word: str) -> str:
        """The corpus' word that an unknown one was probably meant to be; empty when none is near."""
        if len(word) < 4 or not word.isalpha():
            return ""
        from rapidfuzz import process  # noqa: PLC0415 - most words are spelled right
        from rapidfuzz.distance import OSA  # noqa: PLC0415

        allowed = 1 if len(word) < _TWO_TYPOS else 2
        matches = process.extract(word, self._spellings, scorer=OSA.distance, score_cutoff=allowed, limit=5)
        same_start = [match for match in matches if match[0][0] == word[0]]
        ranked = sorted(
            same_start or matches, key=lambda match: (match[1], -self._index.postings(stem(match[0])).units)
        )
        return ranked[0][0] if ranked else ""

    def _concepts(self, text: str) -> list[Concept]:
        """The query's distinct words, each with its stem in this corpus."""
        asked: dict[str, str] = {}
        for word in words(text)[:_MAX_WORDS]:
            if word not in STOP_WORDS:
                asked.setdefault(stem(word), word)
        self._index.postings.load(asked)
        for word in [word for own, word in asked.items() if self._may_be_joined(own, word)]:
            if parts := self._parts_of_class(word):
                del asked[stem(word)]
                asked |= {stem(part): part for part in parts}
        return [self._concept(word, own) for own, word in asked.items()]

    def _may_be_joined(self, own: str, word: str) -> bool:
        """Whether a word is so long and rare that it may be a class's name in small letters."""
        return len(word) >= _JOINED and self._index.postings(own).units < _RARE

    def _parts_of_class(self, word: str) -> list[str]:
        """The words of the class whose name one is in small letters: ``viewlayer``."""
        entries = (self._reader.entry(path) for _, path in self._reader.names.by_key(word))
        return next(
            (words(one.name) for one in entries if one and one.kind == "class" and one.name != word), []
        )

    def _concept(self, word: str, own: str) -> Concept:
        """The word by its own stem, or else by that of its correction."""
        if idf := self._index.idf(own):
            return Concept(word, own, 1.0, idf)
        if corrected := stem(self.correction(word)):
            return Concept(word, corrected, _CORRECTED_WEIGHT, self._index.idf(corrected))
        return Concept(word, "", 0.0, _UNKNOWN_IDF)
