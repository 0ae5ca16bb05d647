"""What is indexed, under which terms, and how strongly."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from kb_build.index.analysis import STOP_WORDS, idf, stem, terms
from kb_build.index.documents import (
    FIELD_WEIGHTS,
    Doc,
    chapter_of,
    definitions,
    make_phrases,
    make_postings,
    make_units,
    packed,
    topic_docs,
    vocabulary,
)
from kb_build.records import EnumItem, Link, Page, Parameter, Section, Symbol

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract

OWNER = Symbol("bpy.types.Cloth", "class", "bpy.types", label="Fabric", group="data", description="A cloth.")
QUALITY = Symbol(
    "bpy.types.Cloth.quality", "property", OWNER.path, label="Steps", description="Finer simulation"
)
PAGE = Page(
    "physics/cloth/index", "manual", "5.1", "Cloth",
    (
        Section("cloth", "Cloth", 1, "Lead text."),
        Section("settings", "Settings", 2, "**Steps**\n    How fine it is."),
    ),
    breadcrumbs=("Physics",),
)  # fmt: skip
LINK = Link(QUALITY.path, "physics/cloth/index#bpy-types-cloth-quality", "manual")


def units(*symbols: Symbol, pages: tuple[Page, ...] = (), links: tuple[Link, ...] = ()) -> list[Doc]:
    return make_units(symbols, pages, links, {}, {})


def test_a_symbol_is_a_unit_with_what_is_said_of_it_anywhere() -> None:
    doc = units(OWNER, QUALITY, pages=(PAGE,), links=(LINK,))[-1]
    assert (doc.ref, doc.kind, doc.title, doc.topic) == (QUALITY.path, "property", "Steps", OWNER.path)
    assert doc.name == ("quality",)
    assert "Fabric" in doc.context
    assert "Finer simulation" in doc.body
    assert "How fine it is." in doc.related
    assert doc.chapter == "physics/cloth"


def test_enum_items_and_arguments_are_found_with_their_symbol() -> None:
    symbol = Symbol(
        "bpy.ops.x.y", "operator", "bpy.ops.x", enum_items=(EnumItem("ONE", "First", "The beginning"),),
        parameters=(Parameter("size", description="How big"),), returns=(Parameter("hit", description="Whether"),),
    )  # fmt: skip
    body = " ".join(units(symbol)[0].body)
    for word in ("ONE", "First", "beginning", "size", "How big", "hit", "Whether"):
        assert word in body


@pytest.mark.parametrize(
    "symbol",
    [
        Symbol("rna_enum_x", "enum", "bpy.types"),
        Symbol("bpy.types.X_PT_y", "class", "bpy.types", group="ui"),
        Symbol("bpy.types.X_OT_y", "class", "bpy.types", group="operator"),
        Symbol("bpy.types.Cloth.bl_rna_get_subclass", "function", OWNER.path),
        Symbol("m.A.__init__", "function", "m.A"),
    ],
)
def test_what_no_script_works_with_is_not_found_by_words(symbol: Symbol) -> None:
    assert symbol.path not in {doc.ref for doc in units(OWNER, symbol)}


def test_members_of_panels_are_left_out_too() -> None:
    panel = Symbol("bpy.types.X_PT_y", "class", "bpy.types", group="ui")
    assert units(panel, Symbol("bpy.types.X_PT_y.draw", "function", panel.path)) == []


def test_every_section_is_a_unit_of_its_page() -> None:
    first, second = units(pages=(PAGE,))
    assert (first.ref, first.anchor, first.title, first.name) == (PAGE.slug, "", "Cloth", (PAGE.slug,))
    assert (second.ref, second.anchor, second.title) == (PAGE.slug, "settings", "Cloth › Settings")
    assert second.context == ("Physics", "Cloth")
    assert {first.topic, second.topic} == {PAGE.slug}


def test_a_page_is_found_by_what_it_explains() -> None:
    first = units(OWNER, QUALITY, pages=(PAGE,), links=(LINK,))[0]
    assert "Steps quality" in first.related


def test_a_topic_holds_the_texts_of_its_units() -> None:
    topics = {doc.ref: doc for doc in topic_docs(units(OWNER, QUALITY, pages=(PAGE,)))}
    assert set(topics) == {OWNER.path, PAGE.slug}
    assert "Finer simulation" in " ".join(topics[OWNER.path].body)
    assert "How fine it is." in " ".join(topics[PAGE.slug].body)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("**Quality Steps**\n    Finer.\n    Slower.\n\nAfter.", {"qualitysteps": "Finer. Slower. "}),
        ("**A**:\n    One.\n**B (unit)**\n    Two.", {"a": "One.", "b": "Two."}),
        ("  **In**\n      Deep.\n\n      Deeper.\n  Out.", {"in": "Deep.  Deeper."}),
        ("A **bold** word.\n    Not a term.", {}),
        ("**Nothing below**", {"nothingbelow": ""}),
        ("", {}),
    ],
)
def test_definition_lists_are_read_by_their_indent(text: str, expected: dict[str, str]) -> None:
    page = Page("a", "manual", "5.1", "A", (Section("", "A", 1, text),))
    assert {name: said.strip() for name, said in definitions(page)} == {
        k: v.strip() for k, v in expected.items()
    }


@pytest.mark.parametrize(
    ("slug", "chapter"),
    [("physics/cloth/settings/index", "physics/cloth"), ("info_gotchas", "info_gotchas"), ("", "")],
)
def test_a_chapter_is_the_first_two_parts_of_a_slug(slug: str, chapter: str) -> None:
    assert chapter_of(slug) == chapter


def test_weights_are_those_of_bm25f_worked_out_by_hand() -> None:
    docs = [
        Doc("a", "property", "A", name=("cloth",), body=("cloth cloth wind",)),
        Doc("b", "property", "B", body=("wind",)),
    ]
    b = 0.5
    postings = make_postings(docs, b)
    body = FIELD_WEIGHTS["body"]
    long, short = 1 - b + b * 3 / 2, 1 - b + b * 1 / 2  # lengths 3 and 1, on average 2
    assert postings.numbers["cloth"] == [0]
    assert postings.weights["cloth"][0] == pytest.approx(FIELD_WEIGHTS["name"] / 1 + 2 * body / long)
    assert postings.numbers["wind"] == [0, 1]
    assert postings.weights["wind"] == pytest.approx([body / long, body / short])


def test_packed_postings_are_numbers_then_weights_of_levels_numbered_through() -> None:
    docs = [Doc(str(n), "property", "", body=("wind " * (n + 1),)) for n in range(5)]
    levels = [make_postings(part, 0.35) for part in (docs, docs[:2])]
    ((term, units, data),) = packed((0, levels[0]), (5, levels[1]))
    numbers = np.frombuffer(data, np.uint32, 7)
    weights = np.frombuffer(data, np.float16, offset=4 * 7).tolist()
    assert (term, units, len(data)) == ("wind", 5, 6 * 7)
    assert numbers.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert weights[:5] == sorted(weights[:5])
    assert weights[5:] == sorted(weights[5:])


def test_nothing_gives_no_postings() -> None:
    for docs in ([], [Doc("a", "class", "A", body=("the of",))]):
        assert list(packed((0, make_postings(docs, 0.35)))) == []


def test_what_a_query_shares_with_a_phrase_is_weighed_to_a_share_of_it() -> None:
    docs = [Doc(name, "property", name, uses=(text,)) for name, text in (("a", "flag wind"), ("b", "wind"))]
    told = make_postings(docs, 0.5)
    uses = {"a": "flag in the wind; of the", "gone": "flag", "page": "the wind"}
    asked, postings = make_phrases(uses, {"a": 0, "page": 2}, len(docs), told)
    rarity = {term: idf(len(docs), len(told.numbers[term])) for term in ("flag", "wind")}
    assert asked == [0, 2]  # neither what says nothing nor what asks for nothing
    assert postings.numbers == {"flag": [0], "wind": [0, 1]}
    shares = [rarity["flag"] * postings.weights["flag"][0], rarity["wind"] * postings.weights["wind"][0]]
    assert sum(shares) == pytest.approx(1)
    assert rarity["wind"] * postings.weights["wind"][1] == pytest.approx(1)


def test_the_vocabulary_keeps_the_most_used_spelling_of_a_stem() -> None:
    docs = [Doc("a", "class", "", body=("collisions collisions collision the",))]
    assert dict(vocabulary(docs)) == {stem("collision"): "collisions"}


def test_every_data_symbol_of_blender_is_found_by_its_own_name(extract: Extract) -> None:
    found = {doc.ref: doc for doc in units(*extract.symbols)}
    assert len(found) > 20_000
    groups = {symbol.path: symbol.group for symbol in extract.symbols}
    for symbol in extract.symbols:
        if symbol.kind in {"property", "operator"} and groups.get(symbol.owner) not in {"ui", "operator"}:
            doc = found.get(symbol.path)
            if doc is None:
                assert symbol.name.startswith(("bl_rna_get_subclass", "__")) or symbol.name in {
                    "input_template", "output_template", "is_registered_node_type",
                }  # fmt: skip
            else:
                assert set(terms(symbol.name)) <= {term for text in doc.name for term in terms(text)}
    assert not set(dict(vocabulary(list(found.values())[:500])).values()) & STOP_WORDS
