"""Everyday words: the table itself, and what they borrow."""

from __future__ import annotations

import pytest

from kb_build.index.analysis import stem
from kb_build.index.documents import Document
from kb_build.index.everyday_words import lend, load_everyday_words, read_everyday_words, unknown_of
from kb_build.index.postings import document_postings


def test_words_lead_to_terms() -> None:
    table = load_everyday_words()
    assert len(table) > 2_000
    assert all(its_terms and all(its_terms) for its_terms in table.values())


def test_rows_of_one_stem_are_one_row() -> None:
    table = read_everyday_words(["# no row: smoke", "plume: smoke, soft body", "plumes: gas"])
    assert table == {stem("plume"): (("smoke",), ("soft", stem("body")), ("gas",))}


def test_a_word_borrows_the_documents_of_its_terms() -> None:
    docs = [
        Document("smoke", "property", "", body=("smoke smoke rises",)),
        Document("plume", "property", "", body=("a plume of smoke",)),
        Document("soft", "property", "", body=("soft light",)),
        Document("jelly", "property", "", body=("soft body",)),
    ]
    units = document_postings(docs, 0.35)
    own = units["plume"].weights[0]
    words = read_everyday_words(["plume: smoke", "blob: soft body", "gadget: widget", "puff: plume"])
    lend(units, unknown_of(words, units))
    assert units["plume"].numbers.tolist() == [0, 1]
    assert units["plume"].weights[1] == own
    assert 0 < units["plume"].weights[0] < units["smoke"].weights[0] / 2
    assert units["blob"].numbers.tolist() == [3]  # all stems of a term
    assert "gadget" not in units
    assert units["puff"].numbers.tolist() == [1]  # what is lent is not lent on


@pytest.mark.parametrize(("count", "borrows"), [(29, True), (30, False)])
def test_a_word_that_is_known_borrows_nothing(count: int, borrows: bool) -> None:
    docs = [Document(f"d{n}", "property", "", body=("plume",)) for n in range(count)]
    units = document_postings([*docs, Document("smoke", "property", "", body=("smoke",))], 0.35)
    assert bool(unknown_of(read_everyday_words(["plume: smoke"]), units)) is borrows
