"""BM25 over the concepts of a query."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from kb_serve.rank.inverted_index import InvertedIndex, Scores, StemPostings


@value_class
class Concept:
    """One word of the query: its stem in the corpus ("" if it has none), the stem's weight, and its idf."""

    word: str
    stem: str
    weight: float
    idf: float


class Scored(NamedTuple):
    """Of every document, by number: its score, and its coverage, the share of the query that it speaks of. What has
    none of the query's stems has 0, as has the one behind them, the topic of what has none.
    """

    scores: Scores
    coverage: Scores


@value_class
class SaidPhrases:
    """Phrases of which a query has a stem, in their order: the document that each asks for, the share of it, by rarity,
    that the query speaks of, and the share of the query that it has.
    """

    asked: NDArray[np.int32]
    shares: Scores
    coverage: Scores


def score_all(index: InvertedIndex, concepts: Sequence[Concept]) -> Scored:
    """Scores the documents of an index by the concepts of a query."""
    documents = index.ends[1] + 1
    scores, coverage = np.zeros(documents, np.float32), np.zeros(documents, np.float32)
    for postings, weight, share in _weighed(index, concepts):
        numbers = postings.numbers[: postings.documents]
        np.add.at(scores, numbers, weight * postings.saturated[: postings.documents])
        np.add.at(coverage, numbers, share)
    return Scored(scores, coverage)


def said_phrases(index: InvertedIndex, concepts: Sequence[Concept], wanted: NDArray[np.bool_]) -> SaidPhrases:
    """The phrases that ask for one of the ``wanted`` documents: there are so many others that they are not scored."""
    weighed = [*_weighed(index, concepts)]
    numbers = np.concatenate([postings.numbers[postings.documents :] for postings, *_ in weighed])
    numbers -= index.ends[1]
    (kept,) = wanted.take(index.asked.take(numbers)).nonzero()
    found = numbers[kept]
    # Which concept has told of each.
    ends = accumulate(len(postings.numbers) - postings.documents for postings, *_ in weighed)
    concept = np.array([*ends]).searchsorted(kept, "right")
    weights = np.array([weight for _, weight, _ in weighed])[concept]
    saturated = np.concatenate([postings.saturated[postings.documents :] for postings, *_ in weighed])[kept]
    phrases = np.sort(found)
    places = phrases.searchsorted(found)  # the first of each phrase: the others of it stay 0
    said = SaidPhrases(
        index.asked[phrases], np.zeros(len(phrases), np.float32), np.zeros(len(phrases), np.float32)
    )
    np.add.at(said.shares, places, weights * saturated)
    np.add.at(said.coverage, places, np.array([share for *_, share in weighed])[concept])
    return said


def _weighed(
    index: InvertedIndex, concepts: Sequence[Concept]
) -> Iterator[tuple[StemPostings, np.float32, np.float32]]:
    """The postings of each concept that has a stem, its weight, and which share of the query it is."""
    whole = sum(concept.idf for concept in concepts) or 1.0
    for concept in concepts:
        if concept.stem:
            weight = concept.weight * concept.idf
            yield index.postings(concept.stem), np.float32(weight), np.float32(weight / whole)
