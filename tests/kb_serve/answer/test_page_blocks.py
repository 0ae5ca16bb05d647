"""What an answer shows of a page, and of a symbol what the manual says of it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.definitions import with_names
from kb_build.pages.page import Section
from kb_serve.answer import pages
from kb_serve.answer.pages import outline, page_blocks, said_of
from kb_serve.knowledge_base import KnowledgeBase

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kb_serve.reader import BaseReader

ALL = 1_000_000
_NAMES = re.compile(r"(?<=\*\*) · `[^`]*`$", re.MULTILINE)  # beside labels


def test_a_page_shows_where_it_stands_and_every_section(kb: KnowledgeBase) -> None:
    page = kb.page("physics/cloth/settings/collisions")
    assert page is not None
    text = _NAMES.sub("", kb.query(page.slug, max_tokens=ALL).text)
    assert "## Physics › Cloth › Settings › Collisions" in text
    assert page.url in text
    for section in page.sections:
        assert section.title in text
        assert section.text in text


@pytest.mark.parametrize(
    ("levels", "told"),
    [
        ((1, 2, 2), "S0, S1, S2"),
        ((1, *[2] * 30, 1), "S0, S31, and 30 more"),
        ([1] * 20, ", ".join(f"S{number}" for number in range(16)) + ", and 4 more"),
    ],
)
def test_a_heading_lists_few_sections_all_and_of_many_the_highest(levels: Sequence[int], told: str) -> None:
    sections = [Section("", f"S{number}", level, "") for number, level in enumerate(levels)]
    assert outline(sections) == told


def test_a_label_of_the_manual_has_its_python_name_beside_it(kb: KnowledgeBase) -> None:
    text = kb.query("physics/cloth/settings/index", max_tokens=ALL).text
    assert "**Quality Steps** · `ClothSettings.quality`\n  How many times" in text
    assert [line for line in text.split("\n") if line.startswith("**") and " · `" in line] == [
        "**Quality Steps** · `ClothSettings.quality`"
    ]


def test_names_beside_labels_do_not_count_for_what_is_shown(reader: BaseReader) -> None:
    block = next(block for block in page_blocks("physics/cloth/settings/index", reader) if block.plain)
    assert "`ClothSettings.quality`" in block.text
    assert block.plain == block.text.replace(" · `ClothSettings.quality`", "")


def test_the_section_asked_for_comes_first(reader: BaseReader, kb: KnowledgeBase) -> None:
    page = kb.page("physics/cloth/settings/collisions")
    assert page is not None
    last = page.sections[-1]
    blocks = list(page_blocks(page.slug, reader, last.anchor))
    assert (blocks[1].plain or blocks[1].text).endswith(last.text)
    assert sorted(block.text for block in blocks) == sorted(
        block.text for block in page_blocks(page.slug, reader)
    )


def test_an_unknown_page_renders_nothing(reader: BaseReader) -> None:
    assert list(page_blocks("nowhere", reader)) == []
    assert reader.manual.manual_url("bpy.types.Nothing") == ""


def test_a_passage_of_an_engines_page_names_the_engine(base: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        pages, "ENGINES", {"physics/cloth/": "An Engine"}
    )  # the miniature manual has no engine's page
    with KnowledgeBase(base) as kb:
        assert "**In the manual** (An Engine › Settings)" in kb.query("ClothSettings.quality").text


def test_pages_below_are_listed(kb: KnowledgeBase) -> None:
    text = kb.query("physics/cloth/index", max_tokens=ALL).text
    assert "**Pages below**" in text
    assert "- `physics/cloth/introduction` (Introduction)" in text


def test_a_symbol_has_the_manuals_words_from_its_own_place(kb: KnowledgeBase) -> None:
    text = kb.query("ClothSettings.quality").text
    assert "**In the manual** (Settings)\nHow many times each frame is solved." in text
    assert "**In the manual**" not in kb.query("ClothSettings.air_damping").text


def test_a_page_that_only_lists_others_says_which(kb: KnowledgeBase, reader: BaseReader) -> None:
    page = reader.manual.page_entry("physics/cloth/settings/index")
    assert page is not None
    assert said_of(page, reader).startswith("Contents: Collisions")
    assert said_of(page._replace(summary="Of cloth."), reader) == "Of cloth."


def test_a_summary_that_a_language_model_wrote_is_marked(reader: BaseReader) -> None:
    page = reader.manual.page_entry("physics/cloth/introduction")
    assert page is not None
    assert "AI summary" not in said_of(page._replace(summary_method="extractive"), reader)
    for method in ("claude", "shipped"):
        written = page._replace(summary="Of cloth.", summary_method=method)
        assert said_of(written, reader) == "AI summary: Of cloth."


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("**Type**", "**Type** · `'X'`"),
        ("  - **Replay:** As played.", "  - **Replay:** `'X'` · As played."),
        ("  - **Replay**", "  - **Replay** · `'X'`"),
        ("As the Final type.", "As the Final type. · `'X'`"),
    ],
)
def test_names_stand_beside_the_term_that_they_are_of(line: str, expected: str) -> None:
    assert with_names(f"Above.\n{line}\nBelow.", 3, {(3, 1): "`'X'`", (2, 0): "`'Y'`"}) == (
        f"Above.\n{expected}\nBelow."
    )


def test_beside_degrees_stands_that_scripts_set_radians(base: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with KnowledgeBase(base) as kb:
        for text, is_told in (("From 1.0° to 180.0°.", True), ("A wide beam.", False)):
            monkeypatch.setattr(
                kb.reader.manual, "passage_text", lambda _, text=text: ("lights", "Spot", text)
            )
            for unit in ("ROTATION", "LENGTH"):
                (block,) = pages.passage_block("bpy.types.SpotLight.spot_size", kb.reader, unit)
                assert ("a script sets radians" in block.text) == (is_told and unit == "ROTATION")
