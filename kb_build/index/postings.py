"""The inverted index: which documents have a stem, and how strongly.

Units, topics and phrases each have lists of BM25F term frequencies: the weighted sum over fields of
tf / (1 - b + b · length / average length) (Robertson & Zaragoza 2009, "The Probabilistic Relevance Framework", section
3.6). Saturation and idf are applied when a query is answered.
"""

from __future__ import annotations

import struct
from array import array
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING

from kb_build.index.analysis import idf, stem, terms, tokens, words_in
from kb_build.index.documents import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.index.documents import Document

# A text → its tokens, or their stems. Texts come several times, in units, topics and phrases: a cache pays.
Tokenize = Callable[[str], Sequence[str]]

FIELD_WEIGHTS = {"name": 1.0, "heading": 2.0, "context": 1.5, "body": 1.0, "related": 0.25, "expansions": 1.5}
UNIT_B = 0.35  # how much a unit's length counts: most are a sentence
TOPIC_B = 0.4


@dataclass(slots=True)
class PostingLists:
    """Stem → (numbers of the documents that have it, weighted term frequencies), ascending by number."""

    numbers: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    weights: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))


def document_postings(documents: Sequence[Document], b: float, stems_of: Tokenize = terms) -> PostingLists:
    """The posting lists of units or of topics; documents are numbered from 0."""

    @cache  # what is around them, the members of a class have in common
    def counted(texts: tuple[str, ...]) -> tuple[Counter[str], int]:
        counter = Counter(chain.from_iterable(map(stems_of, texts)))
        return counter, counter.total()

    fields_of = attrgetter(*FIELDS)
    rows = [list(map(counted, fields_of(document))) for document in documents]
    lengths = [[length for _, length in column if length] for column in zip(*rows, strict=True)]
    average = [sum(column) / max(1, len(column)) for column in lengths]
    postings = PostingLists()
    for number, row in enumerate(rows):
        weights: dict[str, float] = {}
        for name, (counter, length), usual in zip(FIELDS, row, average, strict=True):
            if length:
                scale = FIELD_WEIGHTS[name] / (1 - b + b * length / usual)
                for term, frequency in counter.items():
                    weights[term] = weights.get(term, 0.0) + scale * frequency
        for term, weight in weights.items():
            postings.numbers[term].append(number)
            postings.weights[term].append(weight)
    return postings


def phrase_postings(
    phrases: Iterable[tuple[str, int]],
    units: int,
    unit_postings: PostingLists,
    stems_of: Tokenize = terms,
) -> tuple[list[int], PostingLists]:
    """The documents that phrases lead to, one a phrase, and the phrases' posting lists.

    ``phrases`` are (text, number of its document); those that share no stem with any of the ``units`` are left out. A
    phrase's weight is such that the idf of what a query shares with it, weighed, is a share of 1.
    """
    leads_to: list[int] = []
    postings = PostingLists()
    idfs = {term: idf(units, len(numbers)) for term, numbers in unit_postings.numbers.items()}
    for phrase, document in phrases:
        stems = dict.fromkeys(stems_of(phrase))
        whole = sum([idfs.get(term, 0.0) for term in stems])
        if not whole:
            continue
        for term in stems:
            postings.numbers[term].append(len(leads_to))
            postings.weights[term].append(1 / whole)
        leads_to.append(document)
    return leads_to, postings


def pack_postings(*levels: tuple[int, PostingLists]) -> Iterator[tuple[str, int, bytes]]:
    """(stem, how many units have it, numbers as uint32 then weights as float16) of all levels together.

    Each level comes with the number that its first document gets; the units' comes first.
    """
    for term in dict.fromkeys(term for _, postings in levels for term in postings.numbers):
        numbers, weights = list[int](), list[float]()
        for start, postings in levels:
            if found := postings.numbers.get(term):
                numbers += [start + number for number in found] if start else found
                weights += postings.weights[term]
        units = len(levels[0][1].numbers.get(term, ()))
        yield term, units, array("I", numbers).tobytes() + struct.pack(f"{len(weights)}e", *weights)


def vocabulary(units: Iterable[Document], tokens_of: Tokenize = tokens) -> Iterator[tuple[str, str]]:
    """(stem, most used spelling) for every word of the corpus."""
    texts = (text for unit in units for name in FIELDS for text in getattr(unit, name))
    counts: dict[str, int] = {}
    for token, count in Counter(chain.from_iterable(map(tokens_of, texts))).items():
        for word in words_in(token):
            counts[word] = counts.get(word, 0) + count
    usual: dict[str, str] = {}
    for word, count in counts.items():
        known = usual.setdefault(stem(word), word)
        if count > counts[known]:
            usual[stem(word)] = word
    yield from usual.items()
