"""Which section of a page is asked for: the one that says clearly more of the query than the opening does."""

from __future__ import annotations

import pytest

from kb_build.index.analysis import stem, words
from kb_build.pages.page import Page, Section
from kb_serve.rank.scoring import Concept
from kb_serve.rank.sections import asked_section

FILLER = "There is more to be said about it than fits here, and all of it is said below. " * 3
PAGE = Page(
    "physics/collisions",
    "manual",
    "5.1",
    "Collisions",
    (
        Section("top", "Collisions", 1, FILLER),
        Section(
            "response",
            "Surface Response",
            2,
            f"{FILLER}\n\n**Friction**\n  Resistance.\n\n**Bounciness**\n  How far.",
        ),
        Section("sensitivity", "Sensitivity", 2, f"{FILLER} A margin keeps them apart."),
        Section("removing", "Removing Data", 2, f"{FILLER} Two of them can be removed."),
    ),
)


def asked(query: str) -> str:
    return asked_section(PAGE, [Concept(word, stem(word), 1.0, 5.0) for word in words(query)])


@pytest.mark.parametrize(
    ("query", "anchor"),
    [
        ("bounciness", "response"),
        ("how do I set the bounciness of the surface", "response"),
        ("removing data", "removing"),
        ("collisions", ""),
        ("margin of collisions", "sensitivity"),
        ("xyzzy", ""),
        ("two collisions", ""),  # how many says nothing of a section
        (
            "the margin that a big red rubber ball rolling down green hills needs",
            "",
        ),  # too little of the query
        ("", ""),
    ],
)
def test_the_section_that_says_most_of_the_query_is_asked_for(query: str, anchor: str) -> None:
    assert asked(query) == anchor


def test_a_section_must_say_clearly_more_than_the_opening() -> None:
    opening = Section("top", "Collisions", 1, "A margin keeps them apart.")
    page = Page(PAGE.slug, "manual", "5.1", PAGE.title, (opening, PAGE.sections[2]))
    assert asked_section(page, [Concept("margin", "margin", 1.0, 5.0)]) == ""


def test_a_word_counts_only_where_it_begins() -> None:
    section = Section("more", "More", 2, "Remargined.")
    page = Page(PAGE.slug, "manual", "5.1", PAGE.title, (PAGE.sections[0], section))
    assert asked_section(page, [Concept("margin", "margin", 1.0, 5.0)]) == ""


def test_a_page_without_text_has_no_such_section() -> None:
    page = Page(PAGE.slug, "manual", "5.1", PAGE.title, (Section("a", "A", 1, ""), Section("b", "B", 2, "")))
    assert asked_section(page, [Concept("margin", "margin", 1.0, 5.0)]) == ""
