"""Topic words, as a coder asks at the start of a stage."""

from __future__ import annotations

import ast
import re
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link
from kb_serve.answer.budget import tokens
from kb_serve.answer.topic.overview import Topics
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase


@pytest.fixture(scope="module")
def topics(reader: BaseReader) -> Topics:
    return Topics(reader)


@pytest.mark.parametrize(
    ("text", "slug"),
    [
        ("cloth", "physics/cloth/index"), ("Cloth", "physics/cloth/index"), (" cloth? ", "physics/cloth/index"),
        ("rigid body", "physics/rigid_body/index"), ("rigid bodies", "physics/rigid_body/index"),
        ("what is a rigid body?", "physics/rigid_body/index"), ("explain cloth", "physics/cloth/index"),
        ("rigid_body", ""), ("Rigid Body", "physics/rigid_body/index"), ("physics", "physics/index"),
        ("modifiers", "modeling/modifiers/index"), ("modifier", "modeling/modifiers/index"),
        ("subdivision surface", "modeling/modifiers/generate/subdivision_surface"),
        ("", ""), ("   ", ""), ("xyzzy", ""), ("Camera", ""), ("how do i make a cloth fall", ""), ("cloth.quality", ""),
        ("cloth()", ""), ("a/b", ""), ("\x00", ""), ("🎨", ""),
    ],
)  # fmt: skip
def test_a_few_words_name_a_part_of_the_manual(topics: Topics, text: str, slug: str) -> None:
    assert topics.find(text) == slug


def test_an_overview_tells_the_page_its_classes_operators_and_pages_below(kb: KnowledgeBase) -> None:
    answer = kb.query("cloth", max_tokens=3_000)
    assert answer.kind == "page"
    assert answer.hits[0].id == "physics/cloth/index"
    for part in (
        "## Cloth", "**Classes**", "`bpy.types.ClothModifier`", "`bpy.types.ClothSettings`", "**Operators**",
        "**Pages**",
        "`physics/cloth/settings/index` (Settings)", "  - `physics/cloth/settings/collisions` (Collisions)",
    ):  # fmt: skip
        assert part in answer.text


def test_the_address_is_that_of_the_page_whose_words_are_told(kb: KnowledgeBase) -> None:
    text = kb.query("cloth", max_tokens=3_000).text
    assert "/physics/cloth/introduction.html" in text
    assert "/physics/cloth/index.html" not in text


@pytest.mark.parametrize(
    ("query", "steps"),
    [
        (
            "cloth",
            (
                "obj.modifiers.new(\"Cloth\", 'CLOTH')",
                "on `modifier.settings`",
                "ptcache.bake_all(bake=True)",
            ),
        ),
        (
            "rigid body",
            ("bpy.ops.rigidbody.object_add()", "on `bpy.context.object.rigid_body`", "bake_all(bake=True)"),
        ),
    ],
)
def test_an_overview_begins_with_how_it_is_done_in_order(
    kb: KnowledgeBase, query: str, steps: tuple[str, ...]
) -> None:
    text = kb.query(query, max_tokens=3_000).text
    places = [text.index(part) for part in ("**How it is done**", *steps, "**Classes**", "**Operators**")]
    assert places == sorted(places)


def test_the_steps_of_every_topic_are_python_and_short(topics: Topics, reader: BaseReader) -> None:
    steps = 0
    for (slug,) in reader.rows("SELECT slug FROM pages WHERE source = 'manual'"):
        for block in topics.overview(slug).blocks:
            if block.name == "how it is done":
                assert tokens(block.text) < 1_200
                for code in re.findall(r"`([^`]*)`", block.text):
                    if "(" in code or " = " in code:
                        ast.parse(code)
                        steps += 1
    assert steps > 20


def test_hits_of_an_overview_are_the_ids_it_names(kb: KnowledgeBase) -> None:
    ids = [hit.id for hit in kb.query("rigid body").hits]
    assert ids[0] == "physics/rigid_body/index"
    assert "bpy.types.RigidBodyObject" in ids[:5]
    assert any(identifier.startswith("bpy.ops.rigidbody.") for identifier in ids)


def test_everything_an_overview_names_exists(topics: Topics, reader: BaseReader) -> None:
    for (slug,) in reader.rows("SELECT slug FROM pages WHERE source = 'manual'"):
        overview = topics.overview(slug)
        assert len(set(overview.members)) == len(overview.members)
        for identifier in overview.members:
            assert reader.entry(identifier)
        assert overview.blocks[0].text.startswith("## ")


@pytest.mark.parametrize(
    ("query", "slug"),
    [
        ("physics/cloth/settings/index", "physics/cloth/settings/index"), ("physics/cloth", "physics/cloth/index"),
        ("/physics/cloth/", "physics/cloth/index"), ("physics/cloth/index.html", "physics/cloth/index"),
        ("physics/cloth/introduction.rst", "physics/cloth/introduction"), ("info_overview", "info_overview"),
        ("templates_py/operator_modal", "templates_py/operator_modal"), ("info_traps.html", "info_traps"),
        ("https://docs.blender.org/manual/en/latest/physics/cloth/settings/index.html", "physics/cloth/settings/index"),
        ("https://docs.blender.org/manual/en/5.1/physics/cloth/", "physics/cloth/index"),
        ("see https://docs.blender.org/manual/de/4.2/physics/cloth/settings/collisions.html#self-collisions.",
         "physics/cloth/settings/collisions"),
        ("(https://docs.blender.org/manual/en/dev/physics/cloth/index.html?highlight=cloth)", "physics/cloth/index"),
        ("https://docs.blender.org/api/current/info_overview.html", "info_overview"),
        ("https://docs.blender.org/api/current/bpy.types.ClothSettings.html", "bpy.types.ClothSettings"),
        ("https://docs.blender.org/api/5.1/bpy.types.ClothSettings.html#bpy.types.ClothSettings.quality",
         "bpy.types.ClothSettings.quality"),
        ("https://docs.blender.org/api/current/bpy.ops.object.html#bpy.ops.object.modifier_add",
         "bpy.ops.object.modifier_add"),
        ("https://docs.blender.org/api/current/mathutils.html#mathutils.Vector.lerp", "mathutils.Vector.lerp"),
    ],
)  # fmt: skip
def test_addresses_and_slugs_lead_to_the_page_or_symbol(kb: KnowledgeBase, query: str, slug: str) -> None:
    assert kb.query(query).hits[0].id == slug


def test_every_page_is_found_by_its_slug_its_url_and_among_its_title(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    pages = reader.rows("SELECT slug, title, url, source FROM pages ORDER BY slug")
    assert len(pages) > 50
    for slug, title, url, source in pages:
        assert kb.query(slug).hits[0].id == slug
        if source != "template":
            assert slug in {hit.id for hit in kb.query(title, limit=50).hits}
        if url and source == "manual":
            assert kb.query(url).hits[0].id == slug


def test_a_chapter_is_told_with_the_page_that_it_sends_to(tmp_path: Path) -> None:
    text = "This is the old hair. Read about the new hair on the Hair Nodes page."
    old, new, below = "particles/hair/index", "nodes/hair/index", "particles/hair/length"
    pages = [
        Page(slug, "manual", "5.1", title, (Section("top", title, 1, text),), children=children, links=links)
        for slug, title, children, links in (
            (old, "Hair", (below,), (new, below)),
            (new, "Hair Nodes", (), ()),
            (below, "Length", (), ()),
        )
    ]
    write_base(tmp_path / "base.sqlite", Contents([], pages, (), {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        told = [block.text for block in Topics(own).overview(old).blocks]
    (also,) = [block for block in told if block.startswith("**See also**")]
    assert f"`{new}` (Hair Nodes)" in also
    assert below not in also


def test_what_a_page_says_must_be_there_stands_before_the_steps(tmp_path: Path, reader: BaseReader) -> None:
    slug = "render/cycles/baking"
    sections = (
        Section("top", "Render Baking", 1, "Shaders are baked to images."),
        Section("setup", "Setup", 2, "Baking requires a mesh to have a UV map.\n\nIt takes its time."),
    )
    bake = reader.symbol("bpy.ops.object.bake")
    assert bake
    contents = Contents(
        [bake],
        [Page(slug, "manual", "5.1", "Render Baking", sections)],
        [Link(bake.path, slug, "manual")],
        {},
    )
    write_base(tmp_path / "base.sqlite", contents)
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        told = [block.text for block in Topics(own).overview(slug).first]
    assert told[1].endswith("Baking requires a mesh to have a UV map.")
    assert "bpy.ops.object.bake(" in told[2]


def test_what_scripts_use_most_that_is_called_so_stands_beside_the_page(kb: KnowledgeBase) -> None:
    word, path = "modifiers", "bpy.types.Object.modifiers"
    answer = kb.query(word)
    assert answer.hits[0].is_page
    assert answer.hits[1].id == path
    assert f"- `{path}`" in answer.text.split("**Most used**")[1].split("\n\n")[0]


@pytest.mark.parametrize("word", ["cloth", "wind", "cloth simulation"])
def test_what_is_used_little_or_asked_in_several_words_does_not(kb: KnowledgeBase, word: str) -> None:
    assert "**Most used**" not in kb.query(word).text
