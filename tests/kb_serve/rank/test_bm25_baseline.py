"""A flat index with a single field scores as rank-bm25's BM25Okapi does, but for the idf of common words.

BM25Okapi's idf is ln((N - df + ½) / (df + ½)), negative for a word in more than half of the documents (it then puts a
small constant in its place). Ours is ln(1 + (N - df + ½) / (df + ½)), always positive: ln(1 + exp(theirs)).
"""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from asking import SEED
from rank_bm25 import BM25Okapi

from kb_build.index.analysis import idf, terms
from kb_build.index.documents import Document
from kb_build.index.postings import PostingList, document_postings, pack_postings
from kb_build.schema import UNITS
from kb_serve.rank.inverted_index import K1, InvertedIndex
from kb_serve.rank.scoring import Concept, score_all

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_serve.reader import BaseReader

B = 0.35
WORDS = (
    "cloth", "wind", "flag", "pressure", "collision", "mesh", "vertex", "bake", "frame", "solver", "quality",
    "friction", "mass",
)  # fmt: skip


class FlatIndexReader:
    """What an InvertedIndex reads from a base: one level of documents, no topics, no phrases."""

    def __init__(self, count: int, postings: Mapping[str, PostingList]) -> None:
        self._count = count
        self._postings = {row[0]: row for row in pack_postings((0, postings))}

    def rows(self, sql: str, *values: object) -> list[Any]:
        if "phrases" in sql:
            return [(b"",)]
        count = self._count if values == (UNITS,) else 0
        nowhere, chapters = np.full(count, -1, np.int32), np.zeros(count, np.int32)
        kinds, members = np.zeros(count, np.uint8), np.zeros(count, np.bool_)
        lines = "\n" * max(count - 1, 0)
        columns = (nowhere, chapters, nowhere, kinds, members)
        return [(count, lines, lines, *(column.tobytes() for column in columns))]

    def rows_of(self, sql: str, keys: list[str]) -> list[Any]:
        return [self._postings[key] for key in keys if key in self._postings]


@pytest.fixture(scope="module")
def texts() -> list[str]:
    chance = random.Random(SEED)
    frequent = [*WORDS, *WORDS[:5], *["cloth"] * 20]  # cloth is in more than half of them
    return [" ".join(chance.choices(frequent, k=chance.randint(1, 40))) for _ in range(300)]


@pytest.fixture(scope="module")
def postings(texts: list[str]) -> Mapping[str, PostingList]:
    return document_postings([Document(str(n), "guide", "", body=(text,)) for n, text in enumerate(texts)], B)


@pytest.fixture(scope="module")
def okapi(texts: list[str]) -> Any:
    return BM25Okapi([terms(text) for text in texts], k1=K1, b=B)


def test_idf_is_softplus_of_okapis_for_every_word(
    texts: list[str], postings: Mapping[str, PostingList], okapi: Any
) -> None:
    common = 0
    for word in terms(" ".join(WORDS)):
        having = len(postings[word].numbers)
        theirs = math.log(len(texts) - having + 0.5) - math.log(having + 0.5)
        common += theirs < 0
        assert theirs < 0 or okapi.idf[word] == pytest.approx(theirs)
        assert idf(len(texts), having) == pytest.approx(math.log1p(math.exp(theirs)))
    assert common


@pytest.mark.parametrize("query", ["wind", "cloth wind flag", " ".join(WORDS), "friction of a mass"])
def test_with_the_same_idf_scores_equal_bm25okapi(
    texts: list[str], postings: Mapping[str, PostingList], okapi: Any, query: str
) -> None:
    okapi.idf = {word: idf(len(texts), len(found.numbers)) for word, found in postings.items()}
    expected = np.asarray(okapi.get_scores(terms(query)))
    index = InvertedIndex(cast("BaseReader", FlatIndexReader(len(texts), postings)))
    scored = score_all(index, [Concept(word, word, 1.0, index.idf(word)) for word in terms(query)])
    assert scored.scores[:-1] == pytest.approx(expected, rel=1e-3)  # a base keeps weights as float16
    unpacked = np.zeros(len(texts))
    for word in terms(query):
        weights = postings[word].weights
        unpacked[postings[word].numbers] += okapi.idf[word] * weights * (K1 + 1) / (weights + K1)
    assert unpacked == pytest.approx(expected, rel=1e-9)
