"""Topics of one page: what is asked for in a word or two is answered with how it is set."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link, Symbol
from kb_serve.answer.topic.page_settings import TopicSettings
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

TYPES = "bpy.types."
BLUR = "render/motion_blur"
SCATTER = "nodes/volume_scatter"
SWIRL = "physics/swirl"
NODES = "modeling/geometry_nodes"
HELD = {
    BLUR: ("RenderSettings.use_motion_blur", "RenderSettings.motion_blur_shutter"),
    SCATTER: ("ShaderNodeVolumeScatter",),
    "modifiers/mesh_to_volume": ("MeshToVolumeModifier",),
    "modifiers/volume_to_mesh": ("VolumeToMeshModifier",),
    f"{NODES}/introduction": ("NodesModifier",),
    "physics/forces": ("FieldSettings",),
    "physics/ocean": ("OceanModifier", "OceanModifier.damping", "OceanModifier.depth"),
}
PAGES = (
    Page(
        BLUR, "manual", "5.1", "Motion Blur",
        (Section("m", "Motion Blur", 1, "What moves is smeared.\n\n**Shutter**\n  How long the shutter is open."),),
    ),
    Page(SCATTER, "manual", "5.1", "Volume Scatter", (Section("v", "Volume Scatter", 1, "Makes a fog."),)),
    Page(
        "physics/ocean", "manual", "5.1", "Ocean Modifier",
        (Section("o", "Ocean Modifier", 1, "Makes waves.\n\n**Damping**\n  Calms.\n\n**Depth**\n  Of the water."),),
    ),
    *(
        Page(f"modifiers/{title.lower().replace(' ', '_')}", "manual", "5.1", f"{title} Modifier",
             (Section("m", f"{title} Modifier", 1, "Makes one of the other."),))
        for title in ("Mesh to Volume", "Volume to Mesh")
    ),
    Page(SWIRL, "manual", "5.1", "Turbulence", (Section("t", "Turbulence", 1, "A force that whirls."),)),
    Page(
        f"{NODES}/index", "manual", "5.1", "Geometry Nodes", (Section("g", "Geometry Nodes", 1, "A system of nodes."),),
        children=(f"{NODES}/introduction",),
    ),
    Page(
        f"{NODES}/introduction", "manual", "5.1", "Introduction",
        (Section("i", "Introduction", 1, "A modifier runs them."),), breadcrumbs=("Geometry Nodes",),
    ),
    Page(
        "pictures/index", "manual", "5.1", "Pictures in Rows", (Section("p", "Pictures in Rows", 1, "One by one."),),
        children=(BLUR,),
    ),
    Page("render/film", "manual", "5.1", "Film", (Section("f", "Film", 1, "It says nothing of settings."),)),
)  # fmt: skip


def _symbols(reader: BaseReader) -> list[Symbol]:
    """A few classes of Blender with their members and what they are derived from."""
    owners = (
        "RenderSettings", "ShaderNodeVolumeScatter", "ShaderNode", "Node", "NodeInternal", "OceanModifier", "Modifier",
        "NodesModifier",        "MeshToVolumeModifier", "VolumeToMeshModifier",
        "FieldSettings", "Material", "NodeTree", "ShaderNodeTree", "bpy_struct", "BlendData", "BlendDataMaterials",
        "Object", "ObjectModifiers", "Nodes", "NodeLinks", "Context", "ID",
    )  # fmt: skip
    paths = [f"{TYPES}{owner}" for owner in owners] + ["bpy.ops.object.effector_add"]
    paths += [entry.path for owner in owners for entry in reader.members(f"{TYPES}{owner}").values()]
    return [symbol for path in paths if (symbol := reader.symbol(path))]


@pytest.fixture(scope="module")
def base_of_topics(reader: BaseReader, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base of a few classes and of pages about them."""
    links = [Link(f"{TYPES}{name}", slug, "manual") for slug, names in HELD.items() for name in names]
    path = tmp_path_factory.mktemp("topics") / "base.sqlite"
    write_base(path, Contents(_symbols(reader), PAGES, links, {"minor": "5.1"}))
    return path


@pytest.fixture(scope="module")
def topics(base_of_topics: Path) -> Iterator[KnowledgeBase]:
    """That base as a caller sees it."""
    with KnowledgeBase(base_of_topics) as knowledge:
        yield knowledge


@pytest.mark.parametrize(
    ("query", "slug", "told"),
    [
        (
            "motion blur",
            BLUR,
            ("on `bpy.context.scene.render` (`RenderSettings`):", "  - `motion_blur_shutter` float = 0.5"),
        ),
        ("volume scatter", SCATTER, ('tree.nodes.new("ShaderNodeVolumeScatter")', "How it is done")),
        (
            "ocean",
            "physics/ocean",
            ("`bpy.types.OceanModifier`", "`depth`"),
        ),
    ],
)
def test_a_word_or_two_tell_how_it_is_set(
    topics: KnowledgeBase, query: str, slug: str, told: tuple[str, ...]
) -> None:
    answer = topics.query(query)
    assert (answer.kind, answer.hits[0].id) == ("page", slug)
    assert [part for part in told if part not in answer.text] == []


def test_of_what_is_a_value_the_calls_and_settings_are_told_that_take_it(topics: KnowledgeBase) -> None:
    answer = topics.query("turbulence")
    assert answer.hits[0].id == SWIRL
    call, setting = (
        answer.text.index(text)
        for text in (
            "`bpy.ops.object.effector_add(type='TURBULENCE')`",
            "`obj.field.type = 'TURBULENCE'`",
        )
    )
    assert call < setting


def test_a_setting_is_told_once_and_its_class_with_it(topics: KnowledgeBase) -> None:
    text = topics.query("motion blur").text
    assert text.count("`motion_blur_shutter`") == 1
    assert "bpy.types.RenderSettings.motion_blur_shutter`" not in text


def test_a_value_is_told_where_its_own_part_of_the_manual_has_it(base_of_topics: Path) -> None:
    with closing(BaseReader(base_of_topics)) as reader:
        settings = TopicSettings(reader)
        assert any("obj.field.type" in line for line in settings.as_value("Turbulence", SWIRL))
        assert not [*settings.as_value("Turbulence", "render/swirl")]


def test_a_chapter_that_makes_nothing_tells_the_settings_of_its_pages(topics: KnowledgeBase) -> None:
    answer = topics.query("pictures in rows")
    assert answer.hits[0].id == "pictures/index"
    assert "  - `motion_blur_shutter` float = 0.5" in answer.text


def test_an_overview_is_not_headed_by_what_one_has_to_know_of_one_class(topics: KnowledgeBase) -> None:
    answer = topics.query("geometry nodes")
    assert (answer.kind, answer.hits[0].id) == ("page", f"{NODES}/index")
    assert f"`{TYPES}NodesModifier`" in answer.text
    assert answer.notes == ()
    assert topics.query(f"{TYPES}NodesModifier").notes


def test_a_page_that_sets_nothing_is_no_topic(topics: KnowledgeBase) -> None:
    assert topics.query("film").kind == "candidates"


@pytest.mark.parametrize(
    "query",
    [
        "add an ocean modifier",
        "how do I add an ocean modifier to a mesh from Python?",
        "create the ocean modifier by script",
        "add ocean modifier to the plane",
    ],
)
def test_who_asks_to_add_a_modifier_is_told_how(topics: KnowledgeBase, query: str) -> None:
    answer = topics.query(query)
    assert answer.hits[0].id == "physics/ocean"
    assert "obj.modifiers.new(\"Ocean\", 'OCEAN')" in answer.text


def test_what_is_put_on_bones_is_not_told_for_objects(topics: KnowledgeBase) -> None:
    assert topics.query("add an ocean modifier to a bone").kind == "candidates"


@pytest.mark.parametrize(
    ("query", "slug"),
    [
        ("mesh to volume", "modifiers/mesh_to_volume"),
        ("make volume from mesh", "modifiers/mesh_to_volume"),
        ("a mesh from a volume", "modifiers/volume_to_mesh"),
        ("volume to mesh modifier", "modifiers/volume_to_mesh"),
    ],
)
def test_what_is_made_from_another_thing_is_that_turned_into_it(
    topics: KnowledgeBase, query: str, slug: str
) -> None:
    assert topics.query(query).hits[0].id == slug


def test_a_part_of_a_question_is_told_how_as_well(topics: KnowledgeBase) -> None:
    text = topics.query("add an ocean modifier to the plane and render an image").text
    assert "obj.modifiers.new(\"Ocean\", 'OCEAN')" in text.partition("**2. render an image**")[0]
