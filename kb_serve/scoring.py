"""BM25 over concepts: of the stems that stand for one word of a query, a document's best counts, once.

Only the documents that have any of the query's stems are looked at: a few thousand of the base's thirty.
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kb_serve.inverted import InvertedIndex, Scores


@dataclass(frozen=True, slots=True)
class Concept:
    """One word of the query: corpus stems with weights, and how much the word tells (idf)."""

    word: str
    stems: tuple[tuple[str, float], ...]
    idf: float


@dataclass(frozen=True, slots=True)
class Scored:
    """The documents and phrases that speak of a query, by number, rising; of each its score (of a phrase: the share of
    it, by rarity, that the query speaks of), and its coverage: the share of the query that it speaks of.
    """

    numbers: NDArray[np.intp]
    scores: Scores
    coverage: Scores


def scored(index: InvertedIndex, concepts: Sequence[Concept]) -> Scored:
    """The documents and phrases that have any of the stems."""
    lists = [
        (weight, place, min(concept.idf, found.idf) if weight < 1 else concept.idf, found)
        for place, concept in enumerate(concepts)
        for term, weight in concept.stems
        if len((found := index.postings(term)).numbers)
    ]
    if not lists:
        nothing = np.zeros(0, np.float32)
        return Scored(np.zeros(0, np.intp), nothing, nothing)
    lists.sort(key=itemgetter(0))  # of several weights for one cell, the last that is written stays
    lengths = [len(found.numbers) for *_, found in lists]
    listed = np.concatenate([found.numbers for *_, found in lists])
    numbers, columns = _distinct(listed, index.ends[-1])
    # One row a concept, one column a document.
    cells = columns + np.repeat([place * len(numbers) for _, place, _, _ in lists], lengths)
    shape = len(concepts), len(numbers)
    told, spoken = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    tells = [np.float32(weight * tells) * found.saturated for weight, _, tells, found in lists]
    np.maximum.at(told.reshape(-1), cells, np.concatenate(tells))
    spoken.reshape(-1)[cells] = np.repeat(np.asarray([weight for weight, *_ in lists], np.float32), lengths)
    rarity = np.asarray([concept.idf for concept in concepts], np.float32)
    coverage = rarity @ spoken / np.float32(sum(concept.idf for concept in concepts) or 1.0)
    return Scored(numbers, told.sum(axis=0), coverage)


def _distinct(numbers: NDArray[np.uint32], count: int) -> tuple[NDArray[np.intp], NDArray[np.int32]]:
    """The distinct ones of numbers below ``count``, rising, and for each number its place among them."""
    listed = np.zeros(count, np.bool_)
    listed[numbers] = True
    distinct = np.flatnonzero(listed)
    places = np.empty(count, np.int32)
    places[distinct] = np.arange(len(distinct), dtype=np.int32)
    return distinct, places[numbers]
