"""Which classes belong to a topic, by the pages that explain them."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link
from kb_serve.answer.steps.order import Steps
from kb_serve.answer.topic.classes_and_operators import TopicMembers
from kb_serve.answer.topic.overview import Topics
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kb_serve.answer.steps.names.topic_names import TopicNames

TYPES = "bpy.types."
NODES_OF_GEOMETRY = ("bpy_struct", "Node", "NodeInternal", "GeometryNode")  # what these are derived from
SOFT = "physics/soft_body/settings/simulation"
MOTION = "movie_clip/tracking/index"


def page(slug: str, title: str) -> Page:
    return Page(slug, "manual", "5.1", title, (Section("top", title, 1, "It is set in a panel."),))


def names_of(
    folder: Path,
    reader: BaseReader,
    slug: str,
    title: str,
    explained: dict[str, str],
    others: Sequence[str] = (),
) -> TopicNames:
    """The names of a page's topic in a base of a few classes, each with the page that explains it, and of others."""
    names = [*explained, *others]
    symbols = tuple(symbol for cls in names if (symbol := reader.symbol(f"{TYPES}{cls}")))
    assert len(symbols) == len(names)
    elsewhere = {other for other in explained.values() if other != slug}
    pages = (page(slug, title), *(page(other, "Other Things") for other in sorted(elsewhere)))
    links = tuple(Link(f"{TYPES}{cls}", other, "manual") for cls, other in explained.items())
    write_base(folder / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(folder / "base.sqlite")) as own:
        return TopicMembers(own).names(slug, title)


def members(
    folder: Path, reader: BaseReader, slug: str, title: str, explained: dict[str, str]
) -> frozenset[str]:
    """All classes and operators of the same."""
    names = names_of(folder, reader, slug, title, explained)
    return frozenset({*names.classes, *names.operators})


@pytest.mark.parametrize(
    ("other", "belongs"), [("render/cycles/baking", False), ("physics/particles/baking", True)]
)
def test_a_class_of_another_part_is_not_a_topics_by_its_address_alone(
    tmp_path: Path, reader: BaseReader, other: str, *, belongs: bool
) -> None:
    explained = {"PointCache": "physics/baking", "BakeSettings": other}
    found = members(tmp_path, reader, "physics/baking", "Baking Physics Simulations", explained)
    assert f"{TYPES}PointCache" in found
    assert (f"{TYPES}BakeSettings" in found) is belongs


def test_a_panel_at_the_end_of_a_title_is_only_where_its_matter_is(
    tmp_path: Path, reader: BaseReader
) -> None:
    explained = {"ShapeKey": "animation/shape_keys/introduction"}
    slug = "animation/shape_keys/shape_keys_panel"
    assert f"{TYPES}ShapeKey" in members(tmp_path, reader, slug, "Shape Keys Panel", explained)


MANY = {
    "MovieTracking": "movie_clip/tracking/clip/track",
    "MovieTrackingTrack": "movie_clip/tracking/clip/track",
    "CameraSolverConstraint": "movie_clip/index",
    "TrackToConstraint": "animation/constraints/tracking/track_to",
    "LightProbe": "render/eevee/light_probes/index",
    "NodeClosureInput": "interface/controls/nodes/types/utilities/closure/closure",
    "LatticeModifier": "modeling/modifiers/deform/lattice",
}


@pytest.mark.parametrize(
    ("slug", "title", "elsewhere"),
    [
        ("movie_clip/tracking/index", "Motion Tracking", {"TrackToConstraint"}),
        ("render/lights/index", "Lights", {"LightProbe"}),
        ("modeling/geometry_nodes/closure/index", "Node Closures", set[str]()),
        ("editors/track", "Track Editor", set[str]()),
    ],
)
def test_what_only_shares_a_word_is_another_topics_where_other_chapters_explain_it(
    tmp_path: Path, reader: BaseReader, slug: str, title: str, elsewhere: set[str]
) -> None:
    names = names_of(tmp_path, reader, slug, title, MANY)
    assert names.elsewhere == {f"{TYPES}{cls}" for cls in elsewhere}


def test_what_is_an_element_of_another_topics_thing_is_that_topics(
    tmp_path: Path, reader: BaseReader
) -> None:
    zone = "modeling/geometry_nodes/simulation/simulation_zone"
    explained = {"SoftBodySettings": SOFT, "NodeGeometrySimulationOutputItems": zone}
    node, items = "GeometryNodeSimulationOutput", "NodeGeometrySimulationOutputItems"
    others = [*NODES_OF_GEOMETRY, node, f"{node}.state_items", f"{items}.new", "SimulationStateItem"]
    names = names_of(tmp_path, reader, SOFT, "Simulation", explained, others)
    assert f"{TYPES}SimulationStateItem" in names.elsewhere


def test_steps_make_what_is_called_as_the_topic_wherever_it_is_explained(
    tmp_path: Path, reader: BaseReader
) -> None:
    slug = "animation/lattice"
    explained = {"Lattice": slug, "LatticeModifier": MANY["LatticeModifier"], "LatticePoint": slug}
    names = names_of(tmp_path, reader, slug, "Lattice", explained)
    assert f"{TYPES}LatticeModifier" in names.elsewhere
    told = "".join(Steps(reader, names).told())
    assert "'LATTICE'" in told
    names = names_of(tmp_path, reader, MOTION, "Motion Tracking", MANY)
    told = "".join(Steps(reader, names).told())
    assert "tracks" in told or "tracking" in told
    assert "TRACK_TO" not in told


CHAPTERS = {
    "modeling/geometry_nodes/hair/index": ("Hair Nodes", ("guides", "read", "write")),
    "physics/particles/hair/index": ("Hair", ("introduction",)),
    "interface/controls/nodes/types/closure/index": ("Node Closures", ("closure",)),
    "modeling/geometry_nodes/closure/index": ("Node Closures", ("closure",)),
}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("hair", "physics/particles/hair/index"),
        ("hair nodes", "modeling/geometry_nodes/hair/index"),
        ("hairs", "physics/particles/hair/index"),
        ("closure", "interface/controls/nodes/types/closure/closure"),
    ],
)
def test_a_word_means_the_page_of_that_title_before_the_nodes_that_have_it(
    tmp_path: Path, reader: BaseReader, text: str, found: str
) -> None:
    ends = [f"{TYPES}NodeClosure{end}" for end in ("Input", "Output")]
    bases = {base.path for end in ends for base in reader.lineage(end)}
    symbols = [symbol for path in sorted(bases) if (symbol := reader.symbol(path))]
    pages = [page("render/shader_nodes/closure", "Closure")]
    for slug, (title, below) in CHAPTERS.items():
        slugs = tuple(slug.replace("index", name) for name in below)
        pages.append(replace(page(slug, title), children=slugs))
        pages += [page(one, one.rpartition("/")[2].title()) for one in slugs]
    links = [Link(end, "interface/controls/nodes/types/closure/closure", "manual") for end in ends]
    write_base(tmp_path / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert Topics(own).find(text) == found


def test_a_zone_is_asked_for_with_the_name_of_a_socket(tmp_path: Path, reader: BaseReader) -> None:
    node, slug = f"{TYPES}GeometryNodeRepeatInput", "modeling/geometry_nodes/repeat_zone"
    paths = [node, *(entry.path for entry in reader.members(node).values())]
    symbols = [symbol for path in paths if (symbol := reader.symbol(path))]
    pages = (page(slug, "Repeat Zone"), page("render/repeat", "Repeat"))
    write_base(tmp_path / "base.sqlite", Contents(symbols, pages, (Link(node, slug, "manual"),), {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert Topics(own).find("repeat zone iterations") == slug
        assert Topics(own).find("repeat zone colours") == ""


def test_an_operator_that_is_called_as_a_topic_belongs_to_it(tmp_path: Path, reader: BaseReader) -> None:
    paths = ("bpy.ops.uv.unwrap", "bpy.ops.uv.smart_project")
    symbols = [symbol for path in paths if (symbol := reader.symbol(path))]
    links = [Link(path, "modeling/meshes/editing/uv", "manual") for path in paths]
    for slug, belongs in (("modeling/meshes/uv/unwrapping", True), ("render/unwrapping", False)):
        file = tmp_path / f"{belongs}.sqlite"
        write_base(file, Contents(symbols, (page(slug, "Unwrapping"),), links, {}))
        with closing(BaseReader(file)) as own:
            names = TopicMembers(own).names(slug, "Unwrapping")
        assert ("bpy.ops.uv.unwrap" in names.operators) is belongs
        assert "bpy.ops.uv.smart_project" not in names.operators


def test_a_chapter_works_on_what_its_operators_need_made(tmp_path: Path, reader: BaseReader) -> None:
    owners = {entry.path for entry in reader.descendants(f"{TYPES}Strip")}
    owners |= {
        f"{TYPES}{name}" for name in ("Scene", "SequenceEditor", "StripsTopLevel", "Strip", "BlendData")
    }
    run = [f"bpy.ops.sequencer.{name}" for name in ("enable_proxies", "rebuild_proxy", "refresh_all")]
    paths = [*sorted(owners), *run]
    paths += [entry.path for owner in sorted(owners) for entry in reader.members(owner).values()]
    symbols = [symbol for path in dict.fromkeys(paths) if (symbol := reader.symbol(path))]
    slugs = ("editors/row/index", "editors/one")
    pages = (
        replace(page(slugs[0], "Rows"), children=("editors/row/parts",)),
        page("editors/row/parts", "Parts"),
        page(slugs[1], "Rows"),
    )
    links = [Link(path, slug, "manual") for path in run for slug in slugs]
    write_base(tmp_path / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        chapter, single = (TopicMembers(own).names(slug, "Rows") for slug in slugs)
        told = "".join(Steps(own, chapter).told())
    assert {f"{TYPES}SoundStrip", f"{TYPES}MovieStrip"} <= chapter.classes.keys()
    assert "scene.sequence_editor.strips.new_" in told
    assert f"{TYPES}SoundStrip" not in single.classes


def test_an_address_that_says_only_the_kind_takes_no_others_of_that_kind(
    tmp_path: Path, reader: BaseReader
) -> None:
    slug = "editors/graph_editor/fcurves/modifiers"
    names = names_of(
        tmp_path,
        reader,
        slug,
        "F-Curve Modifiers",
        {"FModifierNoise": slug},
        ["FluidModifier", "EchoModifier"],
    )
    assert names.classes.keys() == {f"{TYPES}FModifierNoise"}
    # Where the address is what the title names, it counts.
    slug = "render/lights/world"
    folder = tmp_path / "world"
    folder.mkdir()
    names = names_of(folder, reader, slug, "World Environment", {"World": slug}, ["WorldMistSettings"])
    assert f"{TYPES}WorldMistSettings" in names.classes


@pytest.mark.parametrize(
    ("other", "belongs"), [("editors/text_editor", False), ("modeling/texts/edit", True)]
)
def test_what_an_editor_does_belongs_to_the_part_of_the_manual_that_explains_it(
    tmp_path: Path, reader: BaseReader, other: str, *, belongs: bool
) -> None:
    slug, paths = "modeling/texts/index", ("bpy.ops.text.cut", "bpy.ops.text.run_script")
    symbols = [symbol for path in paths if (symbol := reader.symbol(path))]
    assert len(symbols) == len(paths)
    links = [Link(path, other, "manual") for path in paths]
    pages = (page(slug, "Text"), page(other, "Other Things"))
    write_base(tmp_path / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert (set(paths) <= TopicMembers(own).names(slug, "Text").operators.keys()) is belongs


@pytest.mark.parametrize(("title", "belongs"), [("Render Output", True), ("Output", False)])
def test_what_a_chapter_does_belongs_to_its_pages_that_say_so(
    tmp_path: Path, reader: BaseReader, title: str, *, belongs: bool
) -> None:
    render = reader.symbol("bpy.ops.render.render")
    assert render
    slug = "render/output/properties"
    pages = (page(slug, title), page("render/index", "Rendering"))
    links = (Link(render.path, "render/index", "manual"),)
    write_base(tmp_path / "base.sqlite", Contents([render], pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert (render.path in TopicMembers(own).names(slug, title).operators) is belongs


TEXT = "modeling/texts/index"
BONES, OBJECTS = "animation/armatures/bones/editing/parenting", "scene_layout/object/editing/parent"
FOG, SKY, FLUID = (
    "render/shader_nodes/shader/volume_scatter",
    "render/shader_nodes/textures/environment",
    "physics/fluid/index",
)
FOUND = {
    BONES: ("Parenting", "bpy.ops.armature.parent_set"),
    OBJECTS: ("Parenting Objects", "bpy.ops.object.parent_set"),
    FOG: ("Volume Scatter", "bpy.types.ShaderNodeVolumeScatter"),
    SKY: ("Environment Texture Node", "bpy.types.ShaderNodeTexEnvironment"),
    FLUID: ("Fluid", "bpy.types.FluidModifier"),
    MOTION: ("Motion Tracking", "bpy.types.MovieTracking"),
    TEXT: ("Text", "bpy.types.TextCurve"),
}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("parenting", OBJECTS),
        ("parent", OBJECTS),
        ("fog", FOG),
        ("volumetric fog", FOG),
        ("HDRI lighting", SKY),
        ("smoke simulation", FLUID),
        ("camera tracking", MOTION),
        ("match moving", MOTION),
        ("matchmove", MOTION),
        ("text objects", TEXT),
        ("a text object", TEXT),
        ("fluid objects", ""),  # no objects are of its data
        # What stands for other things, or of which more is said.
        ("environment fog", ""),
        ("remove fog", ""),
        ("fog in the morning", ""),
    ],
)
def test_a_topic_is_found_by_what_people_call_it(
    tmp_path: Path, reader: BaseReader, text: str, found: str
) -> None:
    paths = (f"{TYPES}Object.type", *(path for _, path in FOUND.values()))
    symbols = [symbol for path in paths if (symbol := reader.symbol(path))]
    pages = [page(slug, title) for slug, (title, _) in FOUND.items()]
    links = [Link(path, slug, "manual") for slug, (_, path) in FOUND.items()]
    write_base(tmp_path / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert Topics(own).find(text) == found


@pytest.mark.parametrize(("text", "found"), [("uv unwrap", 1), ("mesh unwrap", None), ("uv seams", None)])
def test_a_chapter_is_found_with_the_name_of_the_one_that_it_is_in(
    tmp_path: Path, text: str, found: int | None
) -> None:
    slugs = ("mesh/uv/index", "mesh/uv/unwrapping/index", "mesh/uv/unwrapping/seams", "other/mesh/index")
    titles = ("UVs", "Unwrapping", "Seams", "Meshes")
    below = ((slugs[1],), (slugs[2],), (), ("other/mesh/part",))
    pages = [
        replace(page(slug, title), children=children)
        for slug, title, children in zip(slugs, titles, below, strict=True)
    ]
    pages.append(page("other/mesh/part", "Part"))
    write_base(tmp_path / "base.sqlite", Contents([], pages, (), {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert Topics(own).find(text) == ("" if found is None else slugs[found])


@pytest.mark.parametrize(
    ("operators", "found"),
    [
        ({"bpy.ops.object.bake": "render/cycles/baking"}, 0),
        ({"bpy.ops.object.bake": "render/cycles/bake_types"}, None),
        ({}, None),
    ],
)
def test_a_word_for_what_an_operator_does_finds_the_page_on_that(
    tmp_path: Path, reader: BaseReader, operators: dict[str, str], found: int | None
) -> None:
    titled = "modeling/geometry_nodes/baking"
    links = [Link("bpy.ops.object.geometry_node_bake_single", titled, "manual")]
    links += [Link(path, slug, "manual") for path, slug in operators.items()]
    symbols = [symbol for link in links if (symbol := reader.symbol(link.source))]
    pages = [page(titled, "Baking"), *(page(slug, "More on It") for slug in operators.values())]
    write_base(tmp_path / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        slug = titled if found is None else list(operators.values())[found]
        assert {Topics(own).find(word) for word in ("baking", "bake")} == {slug}


def test_the_first_steps_of_a_topic_make_what_it_is_about(tmp_path: Path, reader: BaseReader) -> None:
    node = f"{TYPES}ShaderNodeVolumeScatter"
    made_in = ("Material", "Object", "BlendData", "BlendDataMaterials", "Nodes", "NodeTree", "ShaderNodeTree")
    owners = [node, *(f"{TYPES}{name}" for name in made_in), *(base.path for base in reader.lineage(node))]
    paths = [*owners, *(entry.path for owner in owners for entry in reader.members(owner).values())]
    symbols = [symbol for path in dict.fromkeys(paths) if (symbol := reader.symbol(path))]
    write_base(
        tmp_path / "base.sqlite",
        Contents(symbols, (page(FOG, "Volume Scatter"),), (Link(node, FOG, "manual"),), {}),
    )
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        (*_, last) = Topics(own).first_steps("volume scatter", 2)
    assert "ShaderNodeVolumeScatter" in last
