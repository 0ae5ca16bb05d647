"""The table of what people ask for, as it comes with the package and as it reaches the index."""

from __future__ import annotations

import json
import re

from places import REPO

from kb_build.index.documents import make_units
from kb_build.index.query_expansions import load_uses
from kb_build.records import Link, Page, Section, Symbol

QUERIES = REPO / "corpora" / "queries"


def test_the_table_that_comes_along_is_sound() -> None:
    table = load_uses()
    assert len(table) > 2_000
    for topic, phrases in table.items():
        assert re.fullmatch(r"[\w./-]+", topic), topic
        assert all(phrase.strip() for phrase in phrases.split(";")), topic


def test_the_table_holds_none_of_the_labelled_queries() -> None:
    phrases = {phrase.strip().lower() for row in load_uses().values() for phrase in row.split(";")}
    for path in QUERIES.glob("*.jsonl"):
        queries = {
            json.loads(line)["query"].lower() for line in path.read_text(encoding="utf-8").splitlines()
        }
        assert len({query for query in queries if len(query.split()) > 2} & phrases) == 0


def test_a_page_and_the_class_that_it_explains_are_asked_for_alike() -> None:
    page = Page("physics/cloth", "manual", "5.1", "Cloth", (Section("", "Cloth", 1, ""),))
    cloth = Symbol(path="bpy.types.ClothModifier", kind="class", owner="bpy.types", group="data")
    quality = Symbol(path="bpy.types.ClothModifier.quality", kind="property", owner=cloth.path)
    links = [Link(symbol.path, page.slug, "manual") for symbol in (cloth, quality)]
    units = make_units([cloth, quality], [page], links, {}, {"physics/cloth": "flag in the wind"})
    found = {unit.ref: unit.uses for unit in units}
    assert found["physics/cloth"] == ("flag in the wind",)
    assert found[cloth.path] == ("flag in the wind",)
    assert found[quality.path] == ("",)


def test_a_page_is_asked_for_by_what_it_explains_too() -> None:
    page = Page("physics/cloth", "manual", "5.1", "Cloth", (Section("", "Cloth", 1, ""),))
    mass = Symbol(path="bpy.types.ClothSettings.mass", kind="property", owner="bpy.types.ClothSettings")
    uses = {page.slug: "flag in the wind", mass.path: "heavy curtain"}
    units = make_units([mass], [page], [Link(mass.path, page.slug, "manual")], {}, uses)
    found = {unit.ref: unit.uses for unit in units}
    assert found == {page.slug: ("flag in the wind; heavy curtain",), mass.path: ("heavy curtain",)}


def test_phrases_of_its_own_go_before_those_of_its_page() -> None:
    hit = Symbol(path="bpy.types.Object.ray_cast", kind="function", owner="bpy.types.Object")
    (unit,) = make_units([hit], [], [], {}, {hit.path: "what lies under the mouse"})
    assert unit.uses == ("what lies under the mouse",)
