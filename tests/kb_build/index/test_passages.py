"""The place in the manual that is about a symbol: by its address, else by a label that only it can mean."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.index.passages import address_of, find_passages, keys_of_term
from kb_build.pages.definitions import passage_text, term_lines
from kb_build.pages.page import Page, Section
from kb_build.symbols.flag_names import INVERTED
from kb_build.symbols.records import EnumItem, Link, Symbol

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
    angle = member(SUN, "angle", "Angle")
    assert passage(angle, sections=sections) is None
    assert (
        text_at(passage(angle, sections=(*sections, LIGHTS[2])), (*sections, LIGHTS[2]))
        == "How large the sun looks."
    )


SHARED = "**Strength**\n  How random the strength of a light is.\n\n**Use Pressure**\n  Makes it vary as one presses."
MARKS = tuple(
    (address_of(path), 0)
    for path in (
        "bpy.types.SunLight.strength",
        "bpy.types.SunLight.use_pressure",
        "bpy.ops.light.unset_strength",
    )
)


@pytest.mark.parametrize(
    ("symbol", "said"),
    [
        (member(SUN, "strength", "Light Strength"), "How random the strength of a light is."),
        (member(SUN, "use_pressure", "Use Pressure", "Press the pen to vary it"), "Makes it vary as one presses."),
        (member(SUN, "use_pressure", "Amount", "Random light strength"), "How random the strength of a light is."),
        (Symbol("bpy.ops.light.unset_strength", "operator", "bpy.ops.light", label="Unset Strength"), ""),
    ],
)  # fmt: skip
def test_a_term_with_several_addresses_must_speak_of_the_symbol(symbol: Symbol, said: str) -> None:
    sections = (LIGHTS[0], Section("random", "Randomize", 2, SHARED, MARKS))
    assert text_at(passage(symbol, sections=sections), sections) == said


@pytest.mark.parametrize(
    ("heading", "said"), [("Adding", "Puts one there."), ("Add Light", "Lights are added here.")]
)
def test_an_entry_below_the_heading_with_the_address_goes_before_it(heading: str, said: str) -> None:
    operator = Symbol("bpy.ops.light.add", "operator", "bpy.ops.light", label="Add Light")
    text = "Lights are added here.\n\n**Add Light `A`**\n  Puts one there."
    sections = (LIGHTS[0], Section("add", heading, 2, text, (("bpy-ops-light-add", -1),)))
    assert text_at(passage(operator, sections=sections), sections) == said


def test_where_the_address_leads_to_nothing_the_definition_counts() -> None:
    text = "**Common Options**\n\n**Angle**\n  How wide."
    sections = (LIGHTS[0], Section("more", "Options", 2, text, (("bpy-types-sunlight-angle", 0),)))
    assert text_at(passage(member(SUN, "angle", "Angle"), sections=sections), sections) == "How wide."


@pytest.mark.parametrize(("others", "is_found"), [((), True), (("spots_u",), False)])
def test_the_label_of_settings_is_not_the_collections_that_they_are_named_after(
    others: tuple[str, ...], is_found: bool
) -> None:
    spots = replace(member(SUN, "spots", "Spots", "All spots"), type="collection")
    more = [member(SUN, name, "U") for name in others]
    sections = (LIGHTS[0], Section("more", "Options", 2, "**Spots**\n  How many.\n\n  U, V"))
    found = passage(spots, *more, sections=sections, address=address_of(SUN.path))
    assert (found is not None) is is_found


@pytest.mark.parametrize(("items", "is_found"), [(("Warm", "Cold"), True), (("Warm", "Red"), False)])
def test_a_heading_of_an_enumerations_items_is_its_place(items: tuple[str, ...], is_found: bool) -> None:
    kind = replace(
        member(SUN, "tint", "Tint"),
        enum_items=tuple(EnumItem(item.upper(), item) for item in items),
    )
    text = "**Warm**\n  As a candle.\n\n**Cold**\n  As snow."
    sections = (LIGHTS[0], Section("tint", "Tint", 2, text, (("bpy-types-sunlight-tint", -1),)))
    assert (passage(kind, sections=sections) is not None) is is_found


@pytest.mark.parametrize(
    ("term", "names"),
    [
        ("Levels Viewport, Render", {"levels", "levelsviewport", "renderlevels"}),
        ("Mute/Unmute Strips `H`, `Alt-H`", {"mutestrips", "unmutestrips"}),
        ("Start Handle, End Handle", {"starthandle", "endhandle"}),
        ("Distance (m)", {"distance"}),
    ],
)
def test_a_term_is_found_by_each_of_its_names(term: str, names: set[str]) -> None:
    assert names <= keys_of_term(term)
    assert keys_of_term("Start Handle, End Handle").isdisjoint({"start", "handle"})


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


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Negates.\n\nExamples:\n\n- 1 to 0\n- 0 to 1\n\nMore.", "Negates.\n\nExamples:\n\n- 1 to 0\n- 0 to 1"),
        ("Negates.\n\nThere are two:\n\n- 1\n- 2", "Negates."),
        ("> **Menu:** Add\n\n*Trim* cuts it.\n\nMore.", "*Trim* cuts it."),
        ("`L` selects it.", "`L` selects it."),
        ("**One**\n  Of it.\n\n  In object mode, too.", ""),
    ],
)  # fmt: skip
def test_a_heading_stands_for_its_first_paragraph_with_the_examples_of_it(text: str, said: str) -> None:
    assert passage_text(text, -1) == said


def test_terms_are_lines_in_bold() -> None:
    assert list(term_lines(TEXT)) == [(5, "One"), (6, "Two"), (9, "In"), (12, "Last")]
    assert list(term_lines("A **bold** word.\n**Mass (kg)**:")) == [(1, "Mass (kg)")]
