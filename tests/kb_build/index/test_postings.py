"""The inverted index: weights, packing, phrases and vocabulary."""

from __future__ import annotations

import numpy as np
import pytest

from kb_build.index.analysis import idf, stem
from kb_build.index.documents import Document
from kb_build.index.postings import (
    FIELD_WEIGHTS,
    document_postings,
    pack_postings,
    phrase_postings,
    vocabulary,
)
from kb_build.index.stem_numbers import StemNumbers


def test_weights_are_bm25f_frequencies() -> None:
    docs = [
        Document("a", "property", "A", name=("cloth",), body=("cloth cloth wind",)),
        Document("b", "property", "B", body=("wind",)),
    ]
    b = 0.5
    postings = document_postings(docs, b)
    body = FIELD_WEIGHTS["body"]
    long, short = 1 - b + b * 3 / 2, 1 - b + b * 1 / 2  # lengths 3 and 1, on average 2
    assert postings["cloth"].numbers.tolist() == [0]
    assert postings["cloth"].weights[0] == pytest.approx(FIELD_WEIGHTS["name"] / 1 + 2 * body / long)
    assert postings["wind"].numbers.tolist() == [0, 1]
    assert postings["wind"].weights == pytest.approx([body / long, body / short])


def test_packed_postings_are_numbers_then_weights_of_all_levels() -> None:
    docs = [Document(str(n), "property", "", body=("wind " * (n + 1),)) for n in range(5)]
    levels = [document_postings(part, 0.35) for part in (docs, docs[:2])]
    ((term, units, data),) = pack_postings((0, levels[0]), (5, levels[1]))
    numbers = np.frombuffer(data, np.uint32, 7)
    weights = np.frombuffer(data, np.float16, offset=4 * 7).tolist()
    assert (term, units, len(data)) == ("wind", 5, 6 * 7)
    assert numbers.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert weights[:5] == sorted(weights[:5])
    assert weights[5:] == sorted(weights[5:])


def test_no_content_words_give_no_postings() -> None:
    for docs in ([], [Document("a", "class", "A", body=("the of",))]):
        assert list(pack_postings((0, document_postings(docs, 0.35)))) == []


def test_weighed_idf_of_shared_stems_is_the_share_of_a_phrase() -> None:
    docs = [
        Document(name, "property", name, expansions=(text,))
        for name, text in (("a", "flag wind"), ("b", "wind"))
    ]
    of_units = document_postings(docs, 0.5)
    phrases = [("flag in the wind", 0), (" of the", 0), ("zeppelin", 1), ("the wind", 2)]
    leads_to, postings = phrase_postings(phrases, len(docs), of_units)
    rarity = {term: idf(len(docs), len(of_units[term].numbers)) for term in ("flag", "wind")}
    assert leads_to == [0, 2]  # no phrase of stop words alone, none that no unit shares a word with
    assert {term: found.numbers.tolist() for term, found in postings.items()} == {"flag": [0], "wind": [0, 1]}
    shares = [rarity[term] * postings[term].weights[0] for term in ("flag", "wind")]
    assert sum(shares) == pytest.approx(1)
    assert rarity["wind"] * postings["wind"].weights[1] == pytest.approx(1)


def test_a_text_is_read_as_often_as_it_comes() -> None:
    docs = [
        Document(
            "a", "property", "", name=("wind",), heading=("wind",), body=("wind", "WindForces of the wind")
        ),
        Document("b", "property", ""),
        Document("c", "property", "", body=("wind", "the")),
    ]
    numbers = StemNumbers()
    first, again = (document_postings(docs, 0.0, numbers) for _ in range(2))
    once = sum(FIELD_WEIGHTS[field] for field in ("name", "heading"))
    assert first["wind"].numbers.tolist() == [0, 2]
    assert first["wind"].weights == pytest.approx([once + 3 * FIELD_WEIGHTS["body"], FIELD_WEIGHTS["body"]])
    assert set(first) == {"wind", stem("forces")}
    assert all(again[term].weights.tolist() == found.weights.tolist() for term, found in first.items())


def test_the_vocabulary_keeps_the_most_used_spelling_of_a_stem() -> None:
    docs = [Document("a", "class", "", body=("collisions collisions collision the",))]
    assert dict(vocabulary(docs)) == {stem("collision"): "collisions"}


def test_of_two_that_are_used_as_often_the_vocabulary_keeps_the_shorter() -> None:
    docs = [Document("a", "class", "", body=("collisions collision",))]
    assert dict(vocabulary(docs)) == {stem("collision"): "collision"}
