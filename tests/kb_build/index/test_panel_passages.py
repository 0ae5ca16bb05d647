"""The place in the manual that is about a property, by the panel that shows it."""

from __future__ import annotations

from dataclasses import replace

from kb_build.index.panel_passages import find_panel_passages
from kb_build.pages.definitions import passage_text
from kb_build.pages.page import Page, Section
from kb_build.panels.panel_labels import PanelLabel
from kb_build.symbols.flag_names import INVERTED
from kb_build.symbols.records import Link, Symbol

EMISSION = Section(
    "emission",
    "Emission",
    1,
    "> **Reference:**\n> - **Panel:** Particle System ‣ Emission\n\n**Number**\n  How many there are.\n\n"
    "**Frame Start, End**\n  When they come.\n\n**Lifetime Randomness**\n  How unlike they are.",
)
SOURCE = Section("source", "Source", 2, "**Random**\n  In which order.")
MARKED = Section("marked", "Marked", 2, "**Seed**\n  Of another.", (("bpy-types-texture-seed", 0),))
OTHER = Section(
    "other", "Emission", 1, "> **Reference:**\n> - **Panel:** Render ‣ Emission\n\n**Number**\n  Of lights."
)
IN_EMISSION = PanelLabel(("Emission",), "particle", ())


def setting(name: str, label: str) -> Symbol:
    owner = "bpy.types.ParticleSettings"
    return Symbol(f"{owner}.{name}", "property", owner, label=label, description="A value")


def page(slug: str, *sections: Section) -> Page:
    return Page(slug, "manual", "5.1", sections[0].title, sections)


EMITTERS = page("particles/emission", EMISSION, SOURCE, MARKED)


def said(symbol: Symbol, *shown: PanelLabel, pages: tuple[Page, ...] = (EMITTERS,), link: str = "") -> str:
    """What the manual says of a setting that panels show."""
    links = [Link(symbol.path, link, "manual")] if link else []
    found = find_panel_passages([symbol], pages, links, {symbol.path: shown}, ())
    place = found.get(symbol.path)
    sections = next((one.sections for one in pages if place and one.slug == place.slug), ())
    return passage_text(sections[place.section].text, place.line) if place else ""


def test_the_term_of_the_panel_that_shows_it_is_about_a_setting() -> None:
    assert said(setting("count", "Number"), IN_EMISSION) == "How many there are."


def test_a_panel_of_another_tab_is_another() -> None:
    pages = (EMITTERS, page("render/emission", OTHER))
    assert said(setting("count", "Number"), IN_EMISSION, pages=pages) == "How many there are."
    assert (
        said(setting("count", "Number"), PanelLabel(("Emission",), "render", ()), pages=pages) == "Of lights."
    )
    assert said(setting("count", "Number"), PanelLabel(("Emission",), "physics", ()), pages=pages) == ""


def test_the_text_of_the_panel_is_looked_for_too() -> None:
    shown = replaced_texts("Lifetime Randomness")
    assert said(setting("lifetime_random", "Random"), shown) == "How unlike they are."


def replaced_texts(*texts: str) -> PanelLabel:
    return IN_EMISSION._replace(texts=texts)


def test_a_list_of_terms_is_about_each_of_them() -> None:
    assert said(setting("frame_start", "Start Frame"), replaced_texts("Frame Start")) == "When they come."
    assert said(setting("frame_y", "Up"), replaced_texts("Y")) == ""


def test_a_section_within_is_of_the_panel_within() -> None:
    within = PanelLabel(("Emission", "Source"), "particle", ())
    assert said(setting("use_emit_random", "Random"), within) == "In which order."
    assert said(setting("use_emit_random", "Random"), IN_EMISSION) == ""


def test_a_term_with_another_symbols_address_is_not_taken() -> None:
    marked = PanelLabel(("Emission", "Marked"), "particle", ())
    assert said(setting("seed", "Seed"), marked) == ""


def test_two_terms_of_a_name_are_none() -> None:
    twice = replace(EMISSION, text=f"{EMISSION.text}\n\n**Number**\n  Again.")
    assert said(setting("count", "Number"), IN_EMISSION, pages=(page("a", twice),)) == ""


def test_of_two_pages_on_a_panel_the_one_that_explains_more_counts() -> None:
    less = replace(EMISSION, text=EMISSION.text.partition("**Frame")[0].replace("How many", "How few"))
    pages = (page("a/hair", less), page("b/emitter", EMISSION))
    settings = [setting("count", "Number"), setting("lifetime_random", "Lifetime Randomness")]
    shown = {one.path: [IN_EMISSION] for one in settings}
    found = find_panel_passages(settings, pages, [], shown, ())
    assert {place.slug for place in found.values()} == {"b/emitter"}
    assert len(found) == 2
    assert find_panel_passages(settings[:1], pages, [], shown, ()) == {}  # neither explains more


def test_on_the_symbols_own_page_a_heading_like_the_panel_is_enough() -> None:
    own = page(
        "cameras",
        Section("c", "Display", 1, "A camera."),
        Section("d", "Viewport Display", 2, "**Name**\n  Its name."),
    )
    shown = PanelLabel(("Viewport Display",), "data", ("Name",))
    assert said(setting("show_name", "Show Name"), shown, pages=(own,), link="cameras#d") == "Its name."
    assert said(setting("show_name", "Show Name"), shown, pages=(own,)) == ""
    by_title = page("cameras", Section("c", "Viewport Display", 1, "**Name**\n  Its name."))
    assert said(setting("show_name", "Show Name"), shown, pages=(by_title,), link="cameras") == ""


def test_what_many_panels_show_or_show_the_other_way_round_has_none() -> None:
    count = setting("count", "Number")
    many = [replaced_texts(f"Text {n}") for n in range(4)]
    assert said(count, *many[:1]) != ""
    assert said(count, *many) == ""
    assert said(replace(count, flags=(INVERTED,)), IN_EMISSION) == ""
