"""The place in the manual that is about a symbol: by its address, else by a label that only it can mean."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.index.passages import address_of, find_passages
from kb_build.pages.definitions import passage_text, term_lines
from kb_build.symbols.records import INVERTED, Link, Page, Section, Symbol

if TYPE_CHECKING:
    from kb_build.index.passages import Passage

SLUG = "render/lights"
SUN = Symbol("bpy.types.SunLight", "class", "bpy.types", label="Sun Light")
SPOT = Symbol("bpy.types.SpotLight", "class", "bpy.types", label="Spot Light")
LIGHTS = (
    Section("lights", "Lights", 1, "Light falls."),
    Section("common", "Common", 2, "**Color**\n  The tint of the light.\n\n**Size / Size X**\n  How wide it is."),
    Section(
        "sun", "Sun Light", 2, "It shines.\n\n**Angle**\n  How large the sun looks.", (("bpy-types-sunlight", -1),)
    ),
    Section("spot", "Spot Light", 2, "**Angle**\n  How wide the cone is.", (("bpy-types-spotlight", -1),)),
)  # fmt: skip


def member(cls: Symbol, name: str, label: str, description: str = "A value") -> Symbol:
    return Symbol(f"{cls.path}.{name}", "property", cls.path, label=label, description=description)


def passage(
    symbol: Symbol, *others: Symbol, sections: tuple[Section, ...] = LIGHTS, address: str = ""
) -> Passage | None:
    """Where the page says something about ``symbol``; its classes are linked to the page, too."""
    page = Page(SLUG, "manual", "5.1", "Lights", sections)
    symbols = [SUN, SPOT, *others, symbol]
    links = [
        Link(each.path, f"{SLUG}#{address or address_of(each.path)}", "manual")
        for each in symbols
        if each.kind != "socket"
    ]
    return find_passages(symbols, [page], links).get(symbol.path)


def text_at(found: Passage | None, sections: tuple[Section, ...] = LIGHTS) -> str:
    return passage_text(sections[found.section].text, found.line) if found else ""


@pytest.mark.parametrize(
    ("cls", "said"), [(SUN, "How large the sun looks."), (SPOT, "How wide the cone is.")]
)
def test_of_two_places_with_a_label_the_one_about_the_class_counts(cls: Symbol, said: str) -> None:
    found = passage(member(cls, "angle", "Angle"), address=address_of(cls.path))
    assert text_at(found) == said


def test_where_two_places_fit_there_is_none() -> None:
    light = Symbol("bpy.types.Light", "class", "bpy.types", label="Light")
    assert passage(member(light, "angle", "Angle"), light) is None


def test_what_a_panel_shows_the_other_way_round_has_none() -> None:
    angle = member(SUN, "angle", "Angle")
    assert passage(replace(angle, flags=(INVERTED,)), address=address_of(SUN.path)) is None


def test_a_symbols_address_wins_over_its_label() -> None:
    marked = Section(
        "more",
        "More",
        2,
        "**Opening**\n  Of the cone.\n\n**Angle**\n  Of something.",
        (("bpy-types-spotlight-angle", 0),),
    )
    sections = (*LIGHTS, marked)
    assert text_at(passage(member(SPOT, "angle", "Angle"), sections=sections), sections) == "Of the cone."


def test_a_place_with_anothers_address_is_not_taken() -> None:
    marked = Section("more", "More", 2, "**Source**\n  Of speed.", (("bpy-types-flow-velocity", 0),))
    assert passage(member(SUN, "source", "Source", "Of speed"), sections=(LIGHTS[0], marked)) is None


def test_a_heading_of_another_class_hides_what_is_below() -> None:
    light = Symbol("bpy.types.Light", "class", "bpy.types", label="Light")
    sections = (LIGHTS[0], LIGHTS[3])
    assert passage(member(light, "angle", "Angle"), light, sections=sections) is None


@pytest.mark.parametrize(
    ("label", "description", "is_found"),
    [
        ("Scale", "How large the spots are", True),
        ("Scale", "Of the particles in cells", False),
        ("Texture Scale", "Of the particles in cells", True),
    ],
)
def test_below_a_heading_of_its_own_a_short_label_needs_words_in_common(
    label: str, description: str, is_found: bool
) -> None:
    sections = (LIGHTS[0], Section("texture", "Texture", 2, f"**{label}**\n  Of the spots."))
    found = passage(member(SUN, "scale", label, description), sections=sections)
    assert (found is not None) is is_found


def test_one_of_several_terms_is_enough() -> None:
    assert text_at(passage(member(SUN, "size", "Size X", "How wide"))) == "How wide it is."


@pytest.mark.parametrize(("side", "said"), [("inputs", "What comes."), ("outputs", "What goes.")])
def test_a_sockets_place_is_on_its_side_of_the_node(side: str, said: str) -> None:
    sections = (
        LIGHTS[0],
        Section("in", "Inputs", 2, "**Color**\n  What comes."),
        Section("out", "Outputs", 2, "**Color**\n  What goes."),
    )
    socket = Symbol(f'{SUN.path}.{side}["Color"]', "socket", SUN.path, label="Color")
    assert text_at(passage(socket, sections=sections), sections) == said


def test_a_class_has_the_first_words_of_its_heading() -> None:
    assert text_at(passage(SUN)) == "It shines."
    assert passage(SPOT) is None  # its part of the page begins with a list


@pytest.mark.parametrize(("label", "is_found"), [("Add Light", True), ("Remove Everything", False)])
def test_a_heading_with_an_operators_address_must_speak_of_it(label: str, is_found: bool) -> None:
    operator = Symbol("bpy.ops.light.add", "operator", "bpy.ops.light", label=label)
    section = Section("add", "Adding", 2, "To light a scene, add a lamp.", (("bpy-ops-light-add", -1),))
    assert (passage(operator, sections=(LIGHTS[0], section)) is not None) is is_found


def test_a_place_that_only_refers_elsewhere_is_none() -> None:
    sections = (LIGHTS[0], Section("more", "Options", 2, "**Angle**\n  See Spot."))
    assert passage(member(SUN, "angle", "Angle"), sections=sections) is None


TEXT = "Lead:\n\n- a\n- b\n\n**One**\n**Two**\n  Of both.\n\n  **In**\n    Deep.\n\n**Last**\n\n> **Tip**\n>   Quoted."


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (-1, "Lead:\n\n- a\n- b"),
        (0, "Lead:"),
        (5, "Of both.\n\n**In**\n  Deep."),
        (6, "Of both.\n\n**In**\n  Deep."),
        (9, "Deep."),
        (12, ""),
        (14, "Quoted."),
        (99, ""),
    ],
)
def test_the_text_of_a_place_ends_where_its_indent_does(line: int, said: str) -> None:
    assert passage_text(TEXT, line).strip() == said


def test_terms_are_lines_in_bold() -> None:
    assert list(term_lines(TEXT)) == [(5, "One"), (6, "Two"), (9, "In"), (12, "Last")]
    assert list(term_lines("A **bold** word.\n**Mass (kg)**:")) == [(1, "Mass (kg)")]
