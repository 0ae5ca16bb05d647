"""BM25 over concepts: of the stems that stand for one word of a query, a document's best counts, once.

Only the documents that have any of the query's stems are looked at: a few thousand of the base's thirty.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kb_serve.rank.inverted_index import InvertedIndex, Scores


@dataclass(frozen=True, slots=True)
class Concept:
    """One word of the query: corpus stems with weights, and how much the word tells (idf)."""

    word: str
    stems: tuple[tuple[str, float], ...]
    idf: float


@dataclass(frozen=True, slots=True)
class ScoredDocuments:
    """The documents and phrases that speak of a query, by number, rising; of each its score (of a phrase: the share of
    it, by rarity, that the query speaks of), and its coverage: the share of the query that it speaks of.
    """

    numbers: NDArray[np.intp]
    scores: Scores
    coverage: Scores


class Scorer:
    """Scores by one index. Not to be shared between threads: it has scratch space, which costs more than what is done
    in it where every query has to have its own.
    """

    def __init__(self, index: InvertedIndex) -> None:
        self._index = index
        self._listed = np.zeros(index.ends[-1], np.bool_)
        self._places = np.empty(index.ends[-1], np.intp)

    def score(self, concepts: Sequence[Concept]) -> ScoredDocuments:
        """The documents and phrases that have any of the stems."""
        lists = [
            (place, weight, min(concept.idf, found.idf) if weight < 1 else concept.idf, found)
            for place, concept in enumerate(concepts)
            for term, weight in concept.stems
            if len((found := self._index.postings(term)).numbers)
        ]
        if not lists:
            nothing = np.zeros(0, np.float32)
            return ScoredDocuments(np.zeros(0, np.intp), nothing, nothing)
        # By weight: of several for one document, the last that is written stays.
        lists.sort(key=itemgetter(0, 1))
        numbers, columns = self._distinct(np.concatenate([found.numbers for *_, found in lists]))
        scores, coverage = np.zeros(len(numbers), np.float32), np.zeros(len(numbers), np.float32)
        end = 0
        for place, alike in groupby(lists, key=itemgetter(0)):
            stems = [*alike]
            lengths = [len(found.numbers) for *_, found in stems]
            start, end = end, end + sum(lengths)
            where = columns[start:end]
            told = np.concatenate(
                [np.float32(weight * tells) * found.saturated for _, weight, tells, found in stems]
            )
            spoken = np.repeat(np.asarray([weight for _, weight, *_ in stems], np.float32), lengths)
            if len(stems) > 1:  # each document's best
                best, most = np.zeros(len(numbers), np.float32), np.zeros(len(numbers), np.float32)
                np.maximum.at(best, where, told)
                most[where] = spoken
                scores += best
                coverage += np.float32(concepts[place].idf) * most
            else:
                scores[where] += told
                coverage[where] += np.float32(concepts[place].idf) * spoken
        coverage /= np.float32(sum(concept.idf for concept in concepts) or 1.0)
        return ScoredDocuments(numbers, scores, coverage)

    def _distinct(self, numbers: NDArray[np.uint32]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The distinct ones of numbers, rising, and for each number its place among them."""
        self._listed[numbers] = True
        distinct = np.flatnonzero(self._listed)
        self._listed[distinct] = False
        self._places[distinct] = np.arange(len(distinct))
        return distinct, self._places[numbers]
