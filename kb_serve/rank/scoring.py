"""BM25 over the concepts of a query."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.rank.inverted_index import InvertedIndex, Scores


@dataclass(frozen=True, slots=True)
class Concept:
    """One word of the query: its stem in the corpus ("" if it has none), the stem's weight, and its idf."""

    word: str
    stem: str
    weight: float
    idf: float


@dataclass(frozen=True, slots=True)
class Scored:
    """Of every document and phrase, by number: its score, and its coverage, the share of the query that it speaks of.

    A phrase's score is the share of it, by rarity, that the query speaks of. What has none of the query's stems has 0.
    """

    scores: Scores
    coverage: Scores


def score_all(index: InvertedIndex, concepts: Sequence[Concept]) -> Scored:
    """Scores the documents and phrases of an index by the concepts of a query."""
    scores, coverage = np.zeros(index.ends[-1], np.float32), np.zeros(index.ends[-1], np.float32)
    whole = sum(concept.idf for concept in concepts) or 1.0
    for concept in concepts:
        if not concept.stem:
            continue
        postings = index.postings(concept.stem)
        weight = concept.weight * concept.idf
        np.add.at(scores, postings.numbers, np.float32(weight) * postings.saturated)
        np.add.at(coverage, postings.numbers, np.float32(weight / whole))
    return Scored(scores, coverage)
