"""Which settings the steps of a topic name, and in which order: what counts first, each as what it is."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from asking import TYPES, steps

from kb_build.index.passages import address_of
from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link
from kb_serve.answer.facts.members_in_brief import settings_of
from kb_serve.reader import BaseReader
from measurements.steps import do_steps

if TYPE_CHECKING:
    from pathlib import Path


def told(reader: BaseReader, topic: str, *classes: str) -> list[str]:
    """The steps of a topic, without their numbers; done in Blender, none fails."""
    pytest.importorskip("bpy")
    lines = steps(reader, topic, *classes)
    (done,) = do_steps({topic: lines})
    assert done.done
    assert not done.failed
    return [line.partition(". ")[2] for line in lines]


def place(lines: list[str], beginning: str) -> int:
    return next(number for number, step in enumerate(lines) if step.startswith(beginning))


@pytest.mark.blender
@pytest.mark.parametrize(
    ("topic", "cls", "node"), [("materials", "Material", "principled"), ("world", "World", "background")]
)
def test_what_nodes_decide_comes_before_the_settings_of_what_has_them(
    topic: str, cls: str, node: str, reader: BaseReader
) -> None:
    lines = told(reader, topic, cls)
    assert place(lines, f"set on `{node}`: ") < place(lines, f"set on `{cls.lower()}`: ")


@pytest.mark.blender
def test_a_scene_is_set_before_its_compositor(reader: BaseReader) -> None:
    lines = told(reader, "scenes", "Scene")
    assert place(lines, "set on `scene`: ") < place(lines, "`tree = ")


@pytest.mark.blender
def test_the_settings_of_each_kind_of_light_are_named(reader: BaseReader) -> None:
    lines = told(reader, "lights", "Light", "PointLight", "AreaLight", "SpotLight", "SunLight")
    made = "set on `bpy.data.lights.new("
    kinds = [line.partition("` (`")[2].partition("`")[0] for line in lines if line.startswith(made)]
    assert kinds == ["AreaLight", "SpotLight", "SunLight"]
    assert "`size`" in lines[place(lines, f"{made}\"Area\", 'AREA')")]
    assert "`angle`" in lines[place(lines, f"{made}\"Sun\", 'SUN')")]


@pytest.mark.blender
def test_many_kinds_are_topics_of_their_own(reader: BaseReader) -> None:
    lines = told(reader, "constraints", "Constraint", "CopyRotationConstraint", "TrackToConstraint")
    assert not any(line.startswith("set on `obj.constraints.new(") for line in lines)


@pytest.mark.blender
def test_a_mesh_is_edited_as_a_bmesh_before_anything_is_set_on_it(reader: BaseReader) -> None:
    lines = told(reader, "meshes", "Mesh")
    order = (
        "`bm.from_mesh(object_data)`",
        "call `bmesh.ops.",
        "`bm.to_mesh(object_data)`",
        "set on `object_data`: ",
    )
    places = [place(lines, beginning) for beginning in order]
    assert places == sorted(places)


def test_what_only_the_viewport_displays_is_said_to_be_that(tmp_path: Path, reader: BaseReader) -> None:
    cls = f"{TYPES}Material"
    slug = "render/materials/settings"
    rough, index = f"{cls}.roughness", f"{cls}.pass_index"
    symbols = [reader.symbol(path) for path in (cls, rough, index)]
    sections = (
        Section("top", "Settings", 1, "What a material has."),
        Section(
            "display",
            "Viewport Display",
            2,
            "**Roughness**\n  What Solid shading shows.",
            ((address_of(rough), 0),),
        ),
        Section(
            "other", "Pass Index", 2, "**Pass Index**\n  A number for the pass.", ((address_of(index), 0),)
        ),
    )
    contents = Contents(
        [symbol for symbol in symbols if symbol],
        [Page(slug, "manual", "5.1", "Settings", sections)],
        [Link(path, f"{slug}#{address_of(path)}", "manual") for path in (rough, index)],
        {},
    )
    write_base(tmp_path / "base.sqlite", contents)
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        assert (
            settings_of(cls, own)
            == "`pass_index` = 0; of its display in the viewport alone: `roughness` = 0.4"
        )
