"""Searches the base for a query in plain words.

BM25F over two levels (a unit and the topic around it), with five additions, each measured in ``make bench``:

- *Coverage*: a document's score is scaled by how much of the query, by rarity, it speaks of at all.
- *Phrases*: a document gains by how nearly the query is one of the phrases that it is asked for by.
- *Chapters*: what the best documents mostly come from is probably what the query is about (pseudo-relevance
  feedback); the rest of that chapter gains by it.
- *Code*: a query that speaks of functions or scripts is rather about functions, modules and guides.
- *Variety*: one class or page gives one hit before the others had theirs, and so do the members of one name, and a
  class with the page that explains it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from rapidfuzz import process
from rapidfuzz.distance import OSA

from kb_build.index.analysis import STOP_WORDS, stem, words
from kb_serve.rank.inverted_index import InvertedIndex
from kb_serve.rank.scoring import Concept, Scorer

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from kb_serve.rank.inverted_index import Scores
    from kb_serve.reader import BaseReader

COVERAGE = 1.0  # exponent of the share of the query that a document speaks of
TOPIC_WEIGHT = 0.7
ALONE = 0.5  # what stands in for the topic of a unit that has none
CHAPTER_WEIGHT = 0.2
ASKED_WEIGHT = 0.6  # what a document gains that is asked for just so, in whatever order and number of words
# Who says one of these asks what to call, not where to click.
CODE_WORDS = frozenset(
    """addon api bpy callback code function headless loop method module numpy programmatically python script scripts
    variable""".split()  # noqa: SIM905
)
CODE_WEIGHT = 0.6
FAILED_WEIGHT = 0.3  # the same for an error's message, which a setting may be to blame for too
UNKNOWN_IDF = 6.0
_CORRECTED_WEIGHT = 0.95  # what a corrected word counts, next to one that was written so
_TWO_TYPOS = 9  # letters from which on two may be wrong
_MAX_WORDS = 40
_CANDIDATES = 400
_READ_AHEAD = 16
_MEMBERS = frozenset({"property", "function", "socket"})
_DIFFERENT = 5
_FEEDBACK = 100
_FEEDBACK_POWER = 3  # the weaker half of the feedback documents hardly votes


@dataclass(frozen=True, slots=True)
class SearchHit:
    """One ranked document. ``coverage`` is the share of the query, by rarity, that it speaks of."""

    ref: str
    kind: str
    title: str
    anchor: str
    score: float
    coverage: float


class Searcher:
    """Searches one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self.index = InvertedIndex(reader)

    @cached_property
    def _scorer(self) -> Scorer:
        return Scorer(self.index)

    # The query

    @cached_property
    def vocabulary(self) -> dict[str, str]:
        """stem → most used spelling."""
        return dict(self._reader.rows("SELECT stem, word FROM vocabulary"))

    @cached_property
    def _spellings(self) -> list[str]:
        return list(dict.fromkeys(word for word in self.vocabulary.values() if len(word) > 3))

    def correction(self, word: str) -> str:
        """The corpus' word that an unknown one was probably meant to be; empty when none is near."""
        if len(word) < 4 or not word.isalpha():
            return ""
        allowed = 1 if len(word) < _TWO_TYPOS else 2
        matches = process.extract(word, self._spellings, scorer=OSA.distance, score_cutoff=allowed, limit=5)
        same_start = [match for match in matches if match[0][0] == word[0]]
        ranked = sorted(
            same_start or matches, key=lambda match: (match[1], -self.index.postings(stem(match[0])).units)
        )
        return ranked[0][0] if ranked else ""

    def concepts(self, text: str) -> list[Concept]:
        """The query's distinct words, each with its stem in this corpus."""
        asked: dict[str, str] = {}
        for word in words(text)[:_MAX_WORDS]:
            if word not in STOP_WORDS:
                asked.setdefault(stem(word), word)
        self.index.load(asked)
        return [self._concept(word, own) for own, word in asked.items()]

    def _concept(self, word: str, own: str) -> Concept:
        """The word by its own stem, or else by that of its correction."""
        if idf := self.index.idf(own):
            return Concept(word, own, 1.0, idf)
        if corrected := stem(self.correction(word)):
            return Concept(word, corrected, _CORRECTED_WEIGHT, self.index.idf(corrected))
        return Concept(word, "", 0.0, UNKNOWN_IDF)

    def search(self, text: str, limit: int = 50, *, failed: bool = False) -> list[SearchHit]:
        """The best documents for a text, best first, each id once. ``failed`` where it is an error's message."""
        concepts = self.concepts(text)
        if not self.index.levels[0].count or not any(concept.stem for concept in concepts):
            return []
        units, topics = self.index.levels
        found = self._scorer.score(concepts)
        told = np.asarray(found.scores * found.coverage**COVERAGE, np.float32)
        ends = np.searchsorted(found.numbers, self.index.ends[:2]).tolist()
        if not ends[0]:
            return []
        of_units, of_topics, of_phrases = slice(ends[0]), slice(*ends), slice(ends[1], None)
        numbers, own, coverage = found.numbers[of_units], told[of_units], found.coverage[of_units]
        topical = np.zeros(topics.count + 1, np.float32)  # the last: for the units that have no topic, -1
        topical[found.numbers[of_topics] - units.count] = told[of_topics]
        topic = units.topics[numbers]
        around = np.where(topic >= 0, topical[topic], ALONE * own)
        scores = np.asarray((own + TOPIC_WEIGHT * around) * units.weights[numbers], np.float32)
        if not CODE_WORDS.isdisjoint(words(text)):
            scores *= np.where(units.code[numbers], 1 + CODE_WEIGHT, 1)
        elif failed:
            scores *= np.where(units.code[numbers], 1 + FAILED_WEIGHT, 1)
        phrased = np.sqrt(np.minimum(found.scores[of_phrases], 1) * found.coverage[of_phrases])
        scores *= 1 + ASKED_WEIGHT * self._asked(numbers, topic, found.numbers[of_phrases], phrased)
        scores *= 1 + CHAPTER_WEIGHT * _votes(units.chapters[numbers], scores)
        best = _top(scores, _CANDIDATES)
        best = _spread(best[scores[best] > 0], topic)
        return self._varied(numbers[best], scores[best], coverage[best], limit)

    def _asked(
        self, numbers: NDArray[np.intp], topic: NDArray[np.int32], phrases: NDArray[np.intp], alike: Scores
    ) -> Scores:
        """How nearly the query is, word by word, what units are asked for, 0…1."""
        units, documents, _ = self.index.ends
        best = np.zeros(documents, np.float32)
        np.maximum.at(best, self.index.asked[phrases - documents], alike)
        return np.maximum(best[numbers], np.where(topic >= 0, best[units + topic], 0))

    def _varied(
        self, numbers: NDArray[np.intp], scores: Scores, coverage: Scores, limit: int
    ) -> list[SearchHit]:
        """Of the ranked units each ref once, and the first member of a name before other members of that name.

        A class or operator and the page that explains it say the same: the second of them waits until the first
        few different things have been named.
        """
        first: list[SearchHit] = []
        waiting: list[SearchHit] = []
        later: list[SearchHit] = []
        seen: set[str] = set()
        told = zip(scores.tolist(), coverage.tolist(), self._documents(numbers.tolist()), strict=True)
        for score, share, (ref, kind, title, anchor, page) in told:
            if ref in seen:
                continue
            found = SearchHit(ref, kind, title, anchor, score, share)
            name = f".{ref.rpartition('.')[2]}" if kind in _MEMBERS else ref
            explained = page.partition("#")[0] or ref
            if name in seen:
                later.append(found)
            elif f"/{explained}" in seen and len(first) < _DIFFERENT:
                waiting.append(found)
            else:
                first.append(found)
                if len(first) == _DIFFERENT:
                    first += waiting
            seen.update((ref, name, f"/{explained}"))
            if len(first) >= limit:
                return first[:limit]
        few = waiting if len(first) < _DIFFERENT else []
        return [*first, *few, *later][:limit]

    def _documents(self, numbers: Sequence[int]) -> Iterator[tuple[str, str, str, str, str]]:
        """(ref, kind, title, anchor, manual page) of units, in the order given, read as far as wanted."""
        for start in range(0, len(numbers), _READ_AHEAD):
            wanted = numbers[start : start + _READ_AHEAD]
            units = self._reader.units(wanted)
            if len(units) < len(wanted):
                raise self._reader.damaged("documents of its index are missing")
            yield from (units[number] for number in wanted)


def _spread(places: NDArray[np.intp], topics: NDArray[np.int32]) -> NDArray[np.intp]:
    """Every topic's first, and all that have no topic, before any topic's second."""
    named = topics[places]
    first = named < 0
    first[np.unique(named, return_index=True)[1]] = True
    return np.concatenate((places[first], places[~first]))


def _votes(chapters: NDArray[np.int32], scores: Scores) -> Scores:
    """How much each document's chapter is favoured by the best documents, 0…1."""
    best = _top(scores, _FEEDBACK)
    strength = (scores[best] / max(float(scores[best[0]]), 1e-9)) ** _FEEDBACK_POWER
    votes = np.bincount(chapters[best], strength, int(chapters.max()) + 1).astype(np.float32)
    return (votes / max(float(votes.max()), 1e-9))[chapters]


def _top(scores: Scores, count: int) -> NDArray[np.intp]:
    """The places of the ``count`` highest scores, highest first, equal ones in their order."""
    count = min(count, len(scores))
    best = np.sort(np.argpartition(-scores, count - 1)[:count])
    return best[np.argsort(-scores[best], kind="stable")]
