"""Everyday words: the table itself, and what they borrow."""

from __future__ import annotations

import pytest

from kb_build.index.analysis import stem
from kb_build.index.documents import Document
from kb_build.index.everyday_words import lent_postings, load_everyday_words, read_everyday_words
from kb_build.index.postings import document_postings, pack_postings


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
    table = read_everyday_words(["plume: smoke", "blob: soft body", "gadget: widget"])
    lent = lent_postings(units, units, table)
    assert lent.numbers == {"plume": [0], "blob": [3]}  # those of its own are its own; all stems of a term
    assert 0 < lent.weights["plume"][0] < units.weights["smoke"][0] / 2
    packed = {term: having for term, having, _ in pack_postings((0, units), (0, lent))}
    assert packed["plume"] == 1  # it tells as much as its own documents do,
    assert packed["blob"] == 1  # or else as those that it borrows


@pytest.mark.parametrize(("count", "borrows"), [(29, True), (30, False)])
def test_a_word_that_is_known_borrows_nothing(count: int, borrows: bool) -> None:
    docs = [Document(f"d{n}", "property", "", body=("plume",)) for n in range(count)]
    units = document_postings([*docs, Document("smoke", "property", "", body=("smoke",))], 0.35)
    assert bool(lent_postings(units, units, read_everyday_words(["plume: smoke"])).numbers) is borrows
