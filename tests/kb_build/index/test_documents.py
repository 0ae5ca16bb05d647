"""The documents that are indexed: units of symbols and pages, and the topics around them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.index.analysis import STOP_WORDS, terms
from kb_build.index.documents import Document, chapter_of, kind_of, make_units, topic_documents
from kb_build.index.postings import vocabulary
from kb_build.pages.page import Page, Section
from kb_build.symbols.records import EnumItem, Link, Parameter, Symbol

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


def units(*symbols: Symbol, pages: tuple[Page, ...] = (), links: tuple[Link, ...] = ()) -> list[Document]:
    return make_units(symbols, pages, links, {}, {})


def test_a_symbol_unit_holds_its_own_and_the_manuals_texts() -> None:
    doc = units(OWNER, QUALITY, pages=(PAGE,), links=(LINK,))[-1]
    assert (doc.ref, doc.kind, doc.title, doc.topic) == (QUALITY.path, "property", "Steps", OWNER.path)
    assert doc.name == ("quality",)
    assert "Fabric" in doc.context
    assert "Finer simulation" in doc.body
    assert "How fine it is." in doc.related
    assert doc.chapter == "physics/cloth"


def test_enum_items_arguments_and_results_are_in_the_symbols_body() -> None:
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
def test_symbols_that_no_script_uses_are_not_units(symbol: Symbol) -> None:
    assert symbol.path not in {doc.ref for doc in units(OWNER, symbol)}


def test_members_of_panels_are_not_units() -> None:
    panel = Symbol("bpy.types.X_PT_y", "class", "bpy.types", group="ui")
    assert units(panel, Symbol("bpy.types.X_PT_y.draw", "function", panel.path)) == []


def test_every_section_is_a_unit_of_its_page() -> None:
    first, second = units(pages=(PAGE,))
    assert (first.ref, first.anchor, first.title, first.name) == (PAGE.slug, "", "Cloth", (PAGE.slug,))
    assert (second.ref, second.anchor, second.title) == (PAGE.slug, "settings", "Cloth › Settings")
    assert second.context == ("Physics", "Cloth")
    assert {first.topic, second.topic} == {PAGE.slug}


def test_a_page_unit_names_the_symbols_it_explains() -> None:
    first = units(OWNER, QUALITY, pages=(PAGE,), links=(LINK,))[0]
    assert "Steps quality" in first.related


def test_a_topic_holds_the_texts_of_its_units() -> None:
    topics = {doc.ref: doc for doc in topic_documents(units(OWNER, QUALITY, pages=(PAGE,)))}
    assert set(topics) == {OWNER.path, PAGE.slug}
    assert "Finer simulation" in " ".join(topics[OWNER.path].body)
    assert "How fine it is." in " ".join(topics[PAGE.slug].body)


@pytest.mark.parametrize(
    ("ref", "kind", "expected"),
    [
        ("bpy.types.Cloth", "class", "data"),
        ("mathutils.Vector", "class", "code"),
        ("bpy.types.Cloth.copy", "function", "code"),
        ("bpy.types.Cloth.remove", "function", "removing"),
        ("info_gotchas", "guide", "code"),
        ("bpy.types.ShaderNodeMix", "class", "node"),
        ("modeling/geometry_nodes/mesh/cube", "manual", "node"),
        ("modeling/modifiers/introduction", "manual", "data"),
        ("freestyle.types.Stroke", "class", "rarely asked"),
    ],
)
def test_what_a_document_is_to_the_search(ref: str, kind: str, expected: str) -> None:
    assert kind_of(Document(ref, kind, "")) == expected


def test_a_page_whose_sections_are_all_empty_is_an_index() -> None:
    bare = replace(PAGE, slug="physics/index", sections=(Section("physics", "Physics", 1, "\n"),))
    assert [kind_of(unit) for unit in units(pages=(bare, PAGE))] == ["index", "data", "data"]


@pytest.mark.parametrize(
    ("slug", "chapter"),
    [("physics/cloth/settings/index", "physics/cloth"), ("info_gotchas", "info_gotchas"), ("", "")],
)
def test_a_chapter_is_the_first_two_parts_of_a_slug(slug: str, chapter: str) -> None:
    assert chapter_of(slug) == chapter


def test_every_data_symbol_of_blender_is_a_unit_under_its_name(extract: Extract) -> None:
    by_ref = {document.ref: document for document in units(*extract.symbols)}
    assert len(by_ref) > 20_000
    groups = {symbol.path: symbol.group for symbol in extract.symbols}
    for symbol in extract.symbols:
        if symbol.kind in {"property", "operator"} and groups.get(symbol.owner) not in {"ui", "operator"}:
            document = by_ref.get(symbol.path)
            if document is None:
                assert symbol.name.startswith(("bl_rna_get_subclass", "__")) or symbol.name in {
                    "input_template", "output_template", "is_registered_node_type",
                }  # fmt: skip
            else:
                assert set(terms(symbol.name)) <= {term for text in document.name for term in terms(text)}
    assert not set(dict(vocabulary(list(by_ref.values())[:500])).values()) & STOP_WORDS
