"""The query expansions: the table itself, and how they reach the index."""

from __future__ import annotations

import json
import re

from places import REPO

from kb_build.index.documents import make_units
from kb_build.index.query_expansions import load_query_expansions, placed_expansions
from kb_build.pages.page import Page, Section
from kb_build.summaries.shipped import ShippedSummary
from kb_build.symbols.records import Link, Symbol
from kb_build.versions.removed_symbols import RemovedSymbols

QUERIES = REPO / "corpora" / "queries"
SUMMARIES = REPO / "corpora" / "summaries"


def test_every_topic_has_phrases() -> None:
    table = load_query_expansions()
    assert len(table) > 2_000
    for topic, phrases in table.items():
        assert re.fullmatch(r"[\w./-]+", topic), topic
        assert all(phrase.strip() for phrase in phrases.split(";")), topic


def test_no_phrase_is_a_labelled_query() -> None:
    phrases = {
        phrase.strip().lower() for row in load_query_expansions().values() for phrase in row.split(";")
    }
    for file in SUMMARIES.glob("*.page-*.jsonl"):
        for line in file.read_text(encoding="utf-8").splitlines():
            phrases |= {phrase.lower() for phrase in ShippedSummary.from_line(line).phrases}
    assert len(phrases) > 30_000
    for path in QUERIES.glob("*.jsonl"):
        queries = {
            json.loads(line)["query"].lower() for line in path.read_text(encoding="utf-8").splitlines()
        }
        assert len({query for query in queries if len(query.split()) > 2} & phrases) == 0


def test_a_class_has_the_phrases_of_the_page_that_explains_it() -> None:
    page = Page("physics/cloth", "manual", "5.1", "Cloth", (Section("", "Cloth", 1, ""),))
    cloth = Symbol(path="bpy.types.ClothModifier", kind="class", owner="bpy.types", group="data")
    quality = Symbol(path="bpy.types.ClothModifier.quality", kind="property", owner=cloth.path)
    links = [Link(symbol.path, page.slug, "manual") for symbol in (cloth, quality)]
    units = make_units([cloth, quality], [page], links, {}, {"physics/cloth": "flag in the wind"})
    by_ref = {unit.ref: unit.expansions for unit in units}
    assert by_ref["physics/cloth"] == ("flag in the wind",)
    assert by_ref[cloth.path] == ("flag in the wind",)
    assert by_ref[quality.path] == ("",)


def test_a_page_has_the_phrases_of_the_symbols_it_explains() -> None:
    page = Page("physics/cloth", "manual", "5.1", "Cloth", (Section("", "Cloth", 1, ""),))
    mass = Symbol(path="bpy.types.ClothSettings.mass", kind="property", owner="bpy.types.ClothSettings")
    expansions = {page.slug: "flag in the wind", mass.path: "heavy curtain"}
    units = make_units([mass], [page], [Link(mass.path, page.slug, "manual")], {}, expansions)
    by_ref = {unit.ref: unit.expansions for unit in units}
    assert by_ref == {page.slug: ("flag in the wind; heavy curtain",), mass.path: ("heavy curtain",)}


def test_a_symbol_without_a_page_has_its_own_phrases() -> None:
    hit = Symbol(path="bpy.types.Object.ray_cast", kind="function", owner="bpy.types.Object")
    (unit,) = make_units([hit], [], [], {}, {hit.path: "what lies under the mouse"})
    assert unit.expansions == ("what lies under the mouse",)


def test_phrases_for_what_a_version_lacks_are_said_of_what_it_has_in_its_place() -> None:
    types = "bpy.types."
    table = {
        f"{types}Strip.mute": "silence a strip",
        f"{types}Scene.compositing_node_group": "set up the compositor",
        f"{types}Scene.node_tree": "nodes of the scene",
        f"{types}ActionSlot": "slot of an action",
        f"{types}Object.location": "where it is",
    }
    known = {
        f"{types}{path}"
        for path in ("Sequence.mute", "Scene.node_tree", "Scene.use_nodes", "Object.location")
    }
    rows = (
        (f"{types}Strip.mute", 0, f"{types}Sequence.mute", "", "4.4", "notes"),
        (f"{types}Scene.compositing_node_group", 0, f"{types}Scene.node_tree", "Otherwise.", "5.0", "notes"),
        (f"{types}Scene.compositing_node_group", 1, f"{types}Scene.use_nodes", "", "5.0", "notes"),
    )
    placed = placed_expansions(table, known, lambda: RemovedSymbols(successors=rows))
    assert placed == {
        f"{types}Sequence.mute": "silence a strip",
        f"{types}Scene.node_tree": "nodes of the scene; set up the compositor",
        f"{types}Object.location": "where it is",
    }


def test_what_a_version_lacks_is_not_asked_for_where_it_lacks_nothing() -> None:
    def computed() -> RemovedSymbols:
        raise AssertionError

    assert placed_expansions({"bpy.types.Object": "a thing"}, {"bpy.types.Object"}, computed)
