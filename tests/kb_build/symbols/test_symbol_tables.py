"""The names under which pages are found."""

from __future__ import annotations

from kb_build.index.analysis import topic_key
from kb_build.symbols.records import Page
from kb_build.symbols.tables import action_names


def page(slug: str, title: str) -> Page:
    return Page(slug, "manual", "5.1", title, ())


def test_a_page_on_two_actions_is_found_by_either_of_them() -> None:
    pages = [
        page("files/import_export/index", "Importing & Exporting Files"),
        page("tools", "Tools & Operators"),
    ]
    found = {name for name, _, slug in action_names(pages, ()) if slug == "files/import_export/index"}
    assert found == {topic_key(text) for text in ("import", "export", "import files", "export files")}
    assert {slug for _, _, slug in action_names(pages, ())} == {"files/import_export/index"}


def test_a_word_that_is_the_title_of_another_page_stays_its_own() -> None:
    pages = [page("sculpt_paint/index", "Sculpting & Painting")]
    assert [name for name, *_ in action_names(pages, {topic_key("Sculpting")})] == [topic_key("painting")]
