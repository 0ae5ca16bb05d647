"""Summaries out of a page's own sentences."""

from __future__ import annotations

import pytest

from kb_build.pages.page import Page, Section
from kb_build.summaries.extractive import MAX_CHARS
from kb_build.summaries.methods import summarise

PROSE = (
    "Cloth simulation is one of the hardest aspects of CG. Cloth has very complex internal and environmental "
    "interactions. After years of development, Blender has a very robust cloth simulator."
)


def page(text: str, title: str = "Cloth", **changes) -> Page:
    sections = changes.pop("sections", (Section("top", title, 1, text),))
    return Page(
        **{
            "slug": "physics/cloth",
            "source": "manual",
            "version": "5.1",
            "title": title,
            "sections": sections,
            **changes,
        }
    )


def summary(one: Page, *others: Page) -> str:
    return summarise([one, *others], method="extractive").by_slug[one.slug].text


def test_the_summary_is_one_or_two_sentences_of_the_page_and_marked_as_such():
    outcome = summarise([page(PROSE)], method="extractive")
    found = outcome.by_slug["physics/cloth"]
    assert found.text in PROSE
    assert found.text.endswith(".")
    assert (found.method, found.model) == ("extractive", "extractive")
    assert (outcome.report.method, outcome.report.made, outcome.report.cost) == ("extractive", 1, 0.0)


NOT_PROSE = {
    "a note": "> **Note:** Cloth settings may be slow on old machines, so be patient here.",
    "a list": "- Cloth settings are first of all, and they are here.\n- Cloth settings again are here too.",
    "a numbered list": "1. Cloth settings are first of all, and they are here.",
    "a field list": "- **Panel:** Physics, Cloth settings and everything below it in the editor.",
    "a definition": "**Cloth Quality**\n  Cloth quality sets the number of cloth steps. More is better.",
    "a longer definition": "**Cloth Quality**\n  Number of steps.\n\n  Cloth quality is here.",
    "two terms": "**Cloth Quality**\n**Cloth Steps**\n  Cloth quality sets the number of the cloth steps.",
    "a table": "| Cloth | Settings |\n| --- | --- |\n| Cloth is cloth and so on. | It is a setting. |",
    "code": "```python\n\nCloth is not code. This is not a sentence of cloth settings.\n\n```",
    "code that holds marks": "````\n```\n\nCloth is not code. This is not a sentence of cloth.\n\n```\n````",
    "a caption": "Figure: Cloth settings with a cloth and another cloth on a table of cloth.",
    "a label": "Cloth settings and cloth without a verb or a full stop",
    "an announcement": "The cloth settings of the cloth have these parts of cloth:",
    "a formula": "$$\ncloth = settings. Cloth is one.\n$$",
}


@pytest.mark.parametrize("block", NOT_PROSE.values(), ids=NOT_PROSE.keys())
def test_only_prose_is_chosen(block):
    prose = "A cloth falls. Fabrics made of threads are simulated by this physics type."
    assert summary(page(f"{block}\n\n{prose}")) == prose.removeprefix("A cloth falls. ")
    assert summary(page(f"{prose}\n\n{block}")) == prose.removeprefix("A cloth falls. ")


def test_a_sentence_about_the_title_wins_over_an_introduction():
    text = (
        "Long ago there were no computers, and people drew by hand. A rigid body is an object of the rigid "
        "body simulation that keeps its shape. Shapes vary."
    )
    assert summary(page(text, "Rigid Body")).startswith("A rigid body is an object")


def test_abbreviations_and_numbers_do_not_end_a_sentence():
    text = "The cache, e.g. The Disk Cache, keeps version 2.8 frames, etc. Blender uses it."
    assert summary(page(text)).startswith("The cache, e.g. The Disk Cache, keeps version 2.8 frames")


def test_markup_does_not_reach_the_summary():
    text = (
        "The **Cloth** modifier uses `bpy.types.ClothSettings` and [the *solver*](https://example.org/a_b)."
    )
    assert summary(page(text)) == "The Cloth modifier uses bpy.types.ClothSettings and the solver."


def test_identifiers_keep_their_underscores():
    text = "The function use_self_collision of __init__ sets 2 * 3 * 4 things."
    assert summary(page(text)) == "The function use_self_collision of __init__ sets 2 * 3 * 4 things."


def test_a_long_sentence_is_cut_between_words():
    text = summary(page("The cloth " + "is soft and " * 60 + "ends."))
    assert len(text) <= MAX_CHARS
    assert text.endswith("…")
    assert text.removesuffix("…").split()[-1] in {"is", "soft", "and"}


def test_a_word_without_end_is_cut_too():
    text = summary(page("A" * 5000 + " is long."))
    assert 0 < len(text) <= MAX_CHARS


def test_an_index_page_names_its_children():
    children = ("physics/cloth/a", "physics/cloth/b", "physics/cloth/missing")
    index = page("", children=children)
    others = [page("", "Introduction", slug=children[0]), page("", "Settings", slug=children[1])]
    assert summary(index, *others) == "Cloth. Contents: Introduction, Settings."


def test_a_page_without_prose_or_children_names_its_sections():
    sections = (Section("a", "Cloth", 1, ""), Section("b", "Quality", 2, "- x"), Section("c", "Speed", 2, ""))
    assert summary(page("", sections=sections)) == "Cloth. Contents: Quality, Speed."


def test_a_bare_list_of_settings_names_the_settings():
    text = "**Quality Steps**\n  The number of steps.\n\n**Speed Multiplier**\n  The speed."
    assert summary(page(text)) == "Cloth. Contents: Quality Steps, Speed Multiplier."


def test_the_lead_goes_before_the_sections():
    lead = Section("a", "Cloth", 1, "Fabrics are simulated by this type.")
    below = Section("b", "Cloth Quality", 2, "Cloth quality is about the cloth and the quality of the cloth.")
    assert summary(page("", sections=(lead, below))) == "Fabrics are simulated by this type."


def test_without_a_lead_the_contents_come_first_and_a_sentence_where_there_is_room():
    sections = (
        Section("a", "Cloth", 1, ""),
        Section("b", "Usage", 2, "Fabrics are simulated by this type."),
        Section("c", "Speed", 2, ""),
    )
    assert summary(page("", sections=sections)) == (
        "Cloth. Contents: Usage, Speed. Fabrics are simulated by this type."
    )


@pytest.mark.parametrize("text", ["See the other page for it all.", "This node has no properties.", ""])
def test_an_empty_page_is_summarised_by_the_pages_above_it(text):
    found = summary(page(text, "Blend Node", breadcrumbs=("Editors", "Texture Nodes")))
    assert found == "Blend Node (Editors > Texture Nodes)"


@pytest.mark.parametrize(
    "code",
    [
        '"""\nThis script makes an operator\nthat prints.\n\nMore of it.\n"""\nimport bpy',
        "# This script makes an operator\n# that prints.\n\nimport bpy\n# not this",
    ],
)
def test_a_script_template_is_summarised_by_the_text_at_its_head(code):
    template = page(f"```python\n{code}\n```", "Operator Simple", source="template")
    assert summary(template) == "Operator Simple: This script makes an operator that prints."


@pytest.mark.parametrize(
    "one",
    [
        page("", sections=()),
        page("", "", sections=()),
        page("```\nunclosed"),
        page("**" * 3000),
        page("[" * 5000 + "](" * 5000),
        page("(" * 20000 + ". A"),
        page("`" * 20000),
        page("\x00\x1b[31m. \ud7ff"),
        page("```python\n" * 3000, source="template"),
        page("# " * 10000, source="template"),
        page("*a " * 20000),
        page("A. " * 20000),
    ],
)
def test_hostile_pages_get_a_short_summary_too(one):
    text = summary(one)
    assert 0 < len(text) <= MAX_CHARS
    assert text.isprintable()


def test_the_same_pages_give_the_same_summaries():
    pages = [page(PROSE, slug=str(number)) for number in range(20)]
    assert summarise(pages).by_slug == summarise(pages[::-1]).by_slug
