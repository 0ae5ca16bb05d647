"""BM25 over the concepts of a query.

Only the documents that have any of the query's stems are looked at: a few thousand of the base's thirty.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kb_serve.rank.inverted_index import InvertedIndex, Scores


@dataclass(frozen=True, slots=True)
class Concept:
    """One word of the query: its stem in the corpus ("" if it has none), the stem's weight, and its idf."""

    word: str
    stem: str
    weight: float
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
            (concept, postings)
            for concept in concepts
            if concept.stem and len((postings := self._index.postings(concept.stem)).numbers)
        ]
        if not lists:
            nothing = np.zeros(0, np.float32)
            return ScoredDocuments(np.zeros(0, np.intp), nothing, nothing)
        numbers, columns = self._distinct(np.concatenate([postings.numbers for _, postings in lists]))
        scores, coverage = np.zeros(len(numbers), np.float32), np.zeros(len(numbers), np.float32)
        end = 0
        for concept, postings in lists:
            start, end = end, end + len(postings.numbers)
            where = columns[start:end]
            scores[where] += np.float32(concept.weight * concept.idf) * postings.saturated
            coverage[where] += np.float32(concept.weight) * np.float32(concept.idf)
        coverage /= np.float32(sum(concept.idf for concept in concepts) or 1.0)
        return ScoredDocuments(numbers, scores, coverage)

    def _distinct(self, numbers: NDArray[np.uint32]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The distinct ones of numbers, rising, and for each number its place among them."""
        self._listed[numbers] = True
        distinct = np.flatnonzero(self._listed)
        self._listed[distinct] = False
        self._places[distinct] = np.arange(len(distinct))
        return distinct, self._places[numbers]
