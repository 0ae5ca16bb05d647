"""BM25 over concepts: of the stems that stand for one word of a query, a document's best counts, once.

Only the documents that have any of the query's stems are looked at: a few thousand of the base's thirty.
"""

from __future__ import annotations

from dataclasses import dataclass
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
    """The documents of a level that speak of a query, by number, rising; of each its score, and its coverage: the
    share of the query, by rarity, that it speaks of.
    """

    numbers: NDArray[np.intp]
    scores: Scores
    coverage: Scores


def scored(index: InvertedIndex, level: int, concepts: Sequence[Concept]) -> Scored:
    """The documents of a level that have any of the stems."""
    lists = [
        (weight, place, np.float32(weight * _tells(index, concept, term, weight)), found)
        for place, concept in enumerate(concepts)
        for term, weight in concept.stems
        if (found := index.postings(level, term)) is not None
    ]
    if not lists:
        nothing = np.zeros(0, np.float32)
        return Scored(np.zeros(0, np.intp), nothing, nothing)
    lists.sort(key=lambda row: row[0])  # of several weights for one place, the last that is written stays
    lengths = [len(found.numbers) for *_, found in lists]
    listed = np.concatenate([found.numbers for *_, found in lists])
    numbers, columns = _distinct(listed, index.levels[level].count)
    # One row a concept, one column a document.
    cells = columns + np.repeat([place * len(numbers) for _, place, _, _ in lists], lengths)
    shape = len(concepts), len(numbers)
    told, spoken = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    np.maximum.at(
        told.reshape(-1), cells, np.concatenate([tells * found.saturated for _, _, tells, found in lists])
    )
    spoken.reshape(-1)[cells] = np.repeat(np.asarray([weight for weight, *_ in lists], np.float32), lengths)
    rarity = np.asarray([concept.idf for concept in concepts], np.float32)
    coverage = rarity @ spoken / np.float32(sum(concept.idf for concept in concepts) or 1.0)
    return Scored(numbers, told.sum(axis=0), coverage)


def _tells(index: InvertedIndex, concept: Concept, term: str, weight: float) -> float:
    """How much a stem tells: the query's own word by itself, another no more than the word it stands for."""
    return concept.idf if weight == 1.0 else min(concept.idf, index.idf(term))


def _distinct(numbers: NDArray[np.uint32], count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The distinct ones of numbers below ``count``, rising, and for each number its place among them."""
    listed = np.zeros(count, np.bool_)
    listed[numbers] = True
    distinct = np.flatnonzero(listed)
    places = np.empty(count, np.intp)
    places[distinct] = np.arange(len(distinct))
    return distinct, places[numbers]
