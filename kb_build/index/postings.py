"""The inverted index: which documents have a stem, and how strongly.

Units, topics and phrases each have lists of BM25F term frequencies: the weighted sum over fields of
tf / (1 - b + b · length / average length) (Robertson & Zaragoza 2009, "The Probabilistic Relevance Framework", section
3.6). Saturation and idf are applied when a query is answered.
"""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kb_build.index.analysis import idf, stem, words_in
from kb_build.index.documents import FIELDS
from kb_build.index.stem_numbers import StemNumbers

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from kb_build.index.documents import Document

FIELD_WEIGHTS = {"name": 1.0, "heading": 2.0, "context": 1.5, "body": 1.0, "related": 0.25, "expansions": 1.5}
UNIT_B = 0.35  # how much a unit's length counts: most are a sentence
TOPIC_B = 0.4


class PostingList(NamedTuple):
    """The numbers of the documents that have a stem, ascending, and their weighted term frequencies."""

    numbers: NDArray[np.intp]
    weights: NDArray[np.float64]


NOWHERE = PostingList(np.zeros(0, np.intp), np.zeros(0))


def document_postings(
    documents: Sequence[Document], b: float, numbers: StemNumbers | None = None
) -> dict[str, PostingList]:
    """Stem → its posting list, of units or of topics; documents are numbered from 0."""
    numbers = numbers or StemNumbers()
    places: list[NDArray[np.intp]] = []
    weights: list[NDArray[np.float64]] = []
    for name in FIELDS:
        rows = numbers.rows([*map(attrgetter(name), documents)])
        lengths = np.bincount(rows.documents, minlength=len(documents))
        usual = lengths.sum() / max(1, np.count_nonzero(lengths))
        scale = FIELD_WEIGHTS[name] / (1 - b + b * lengths / (usual or 1))
        places.append(rows.stems * len(documents) + rows.documents)
        weights.append(scale[rows.documents])
    return _lists(np.concatenate(places), np.concatenate(weights), len(documents), numbers.stems)


def _lists(
    places: NDArray[np.intp], weights: NDArray[np.float64], documents: int, stems: list[str]
) -> dict[str, PostingList]:
    """Stem → its posting list. A place is a stem's number times the count of documents, plus a document's number;
    what has one place is added up.
    """
    if not len(places):
        return {}
    order = np.argsort(places, kind="stable")
    sorted_places = places[order]
    first = np.flatnonzero(np.diff(sorted_places, prepend=-1))
    summed = np.add.reduceat(weights[order], first)
    of_stem, of_document = np.divmod(sorted_places[first], documents)
    cuts = np.flatnonzero(np.diff(of_stem, prepend=-1))
    ends = [*cuts[1:].tolist(), len(of_stem)]
    return {
        stems[number]: PostingList(of_document[start:end], summed[start:end])
        for number, start, end in zip(of_stem[cuts].tolist(), cuts.tolist(), ends, strict=True)
    }


def phrase_postings(
    phrases: Sequence[tuple[str, int]],
    units: int,
    unit_postings: Mapping[str, PostingList],
    numbers: StemNumbers | None = None,
) -> tuple[list[int], dict[str, PostingList]]:
    """The documents that phrases lead to, one a phrase, and the phrases' posting lists by stem.

    ``phrases`` are (text, number of its document); those that share no stem with any of the ``units`` are left out. A
    phrase's weight is such that the idf of what a query shares with it, weighed, is a share of 1.
    """
    numbers = numbers or StemNumbers()
    rows = numbers.rows([(text,) for text, _ in phrases])
    stems = numbers.stems
    rarity = np.array([idf(units, len(unit_postings.get(one, NOWHERE).numbers)) for one in stems])
    count = max(1, len(phrases))
    # A phrase says a stem once, however often it has it.
    of_stem, of_phrase = np.divmod(np.unique(rows.stems * count + rows.documents), count)
    whole = np.bincount(of_phrase, rarity[of_stem], count)
    kept = whole > 0
    of_stem, of_phrase = of_stem[kept[of_phrase]], of_phrase[kept[of_phrase]]
    renumbered = np.cumsum(kept) - 1
    leads_to = [document for (_, document), is_kept in zip(phrases, kept.tolist(), strict=False) if is_kept]
    places = of_stem * count + renumbered[of_phrase]
    return leads_to, _lists(places, 1 / whole[of_phrase], count, stems)


def pack_postings(*levels: tuple[int, Mapping[str, PostingList]]) -> Iterator[tuple[str, int, bytes]]:
    """(stem, how many units have it, numbers as uint32 then weights as float16) of all levels together.

    Each level comes with the number that its first document gets; the units' comes first.
    """
    for term in dict.fromkeys(term for _, postings in levels for term in postings):
        found = [(start, postings[term]) for start, postings in levels if term in postings]
        numbers = b"".join((start + one.numbers).astype(np.uint32).tobytes() for start, one in found)
        weights = b"".join(one.weights.astype(np.float16).tobytes() for _, one in found)
        yield term, len(levels[0][1].get(term, NOWHERE).numbers), numbers + weights


def vocabulary(units: Iterable[Document], numbers: StemNumbers | None = None) -> Iterator[tuple[str, str]]:
    """(stem, most used spelling) for every word of the corpus."""
    numbers = numbers or StemNumbers()
    texts = [text for unit in units for name in FIELDS for text in getattr(unit, name)]
    counts: dict[str, int] = {}
    for token, times in numbers.token_counts(texts):
        for word in words_in(token):
            counts[word] = counts.get(word, 0) + times
    usual: dict[str, str] = {}
    for word in sorted(counts, key=lambda word: (-counts[word], len(word), word)):
        usual.setdefault(stem(word), word)
    yield from usual.items()
