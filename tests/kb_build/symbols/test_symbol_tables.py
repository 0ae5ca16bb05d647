"""The names under which pages are found, and what is known of symbols without their records."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kb_build.index.analysis import topic_key
from kb_build.pages.page import Page
from kb_build.schema import Mark
from kb_build.symbols.records import Deprecation, EnumItem, NewValue, Parameter, Symbol
from kb_build.symbols.tables import action_names, choices_of, marks_of


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


POINTER = Symbol("bpy.types.A.x", "property", "bpy.types.A", type="pointer", target="T")
NUMBER = Symbol("bpy.types.A.n", "property", "bpy.types.A", type="int", default=5, flags=("compared",))


@pytest.mark.parametrize(
    ("symbol", "marks"),
    [
        (NUMBER, Mark(0)),
        (replace(NUMBER, flags=()), Mark.UNSEEN),
        (replace(NUMBER, flags=(), default=None), Mark(0)),
        (replace(NUMBER, flags=("readonly", "compared")), Mark.READ_ONLY),
        (replace(NUMBER, flags=("locked-on:any", "compared")), Mark.READ_ONLY),
        (replace(NUMBER, flags=("locked-on:mesh", "compared")), Mark(0)),
        (replace(NUMBER, deprecation=Deprecation("gone")), Mark.DEPRECATED),
        (POINTER, Mark(0)),
        (replace(POINTER, new_values=(NewValue(None),)), Mark.GIVEN),
        (replace(POINTER, new_values=(NewValue(None),), flags=("filled-by:a.b()",)), Mark(0)),
        (replace(POINTER, new_values=(NewValue(None, ("empty object",)),)), Mark(0)),
        (replace(POINTER, new_values=(NewValue(None),), flags=("readonly",)), Mark.GIVEN | Mark.READ_ONLY),
    ],
)
def test_marks_say_what_lists_of_members_ask_of_a_symbol(symbol: Symbol, marks: Mark) -> None:
    assert marks_of(symbol) == marks


def test_choices_are_the_words_of_arguments_and_values_that_a_line_leaves_out() -> None:
    items = (EnumItem("CROSS", "Cross Fades"), EnumItem("ADD", "Add"))
    called = Symbol(
        "bpy.ops.a.b",
        "operator",
        "bpy.ops.a",
        parameters=(Parameter("frame_start", "int", label="Start"), Parameter("type", enum_items=items)),
    )
    assert set(choices_of(called).split()) == {"cross", "fade", "add", "frame", "start", "type"}
    assert choices_of(replace(called, parameters=())) == ""
    assert choices_of(replace(NUMBER, type="enum", enum_items=items)) == ""  # few: its line has them
