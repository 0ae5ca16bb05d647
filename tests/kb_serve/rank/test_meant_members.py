"""What is told of a name that no Blender has: the member that is meant, by what people call it."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_serve.rank.meant_members import meant_members
from kb_serve.rank.search import Searcher
from kb_serve.reader import BaseReader
from kb_serve.recognise.recognition import MissingName

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.rank.meant_members import MeantMembers

T = "bpy.types."


@pytest.fixture(scope="module")
def reader(base: Path) -> Iterator[BaseReader]:
    with closing(BaseReader(base)) as reader:
        yield reader


@pytest.fixture(scope="module")
def searcher(reader: BaseReader) -> Searcher:
    return Searcher(reader)


def meant(owner: str, name: str, searcher: Searcher, reader: BaseReader) -> MeantMembers:
    return meant_members(MissingName(name, T + owner), searcher, reader)


@pytest.mark.parametrize(
    ("owner", "name", "member"),
    [
        ("Object", "position", "Object.location"),
        ("RigidBodyObject", "bounciness", "RigidBodyObject.restitution"),
        ("ShapeKey", "weight", "ShapeKey.value"),
        ("NodeLink", "source", "NodeLink.from_node"),
        ("Camera", "far", "Camera.clip_end"),
        ("Light", "intensity", "PointLight.energy"),  # of its cases
        ("ID", "fov", "Camera.angle"),  # of an object's data
        ("Object", "keyframes", "bpy_struct.keyframe_insert"),  # of all
    ],
)
def test_the_search_finds_what_a_class_calls_otherwise(
    owner: str, name: str, member: str, searcher: Searcher, reader: BaseReader
) -> None:
    found = meant(owner, name, searcher, reader)
    assert found.paths[0] == T + member
    assert found.clear


def test_what_is_assigned_is_no_function_and_what_is_called_is_one(
    searcher: Searcher, reader: BaseReader
) -> None:
    def kind(*, assigned: bool = False, called: bool = False) -> str:
        missing = MissingName("resize", f"{T}Image", assigned=assigned, called=called)
        entry = reader.entry(meant_members(missing, searcher, reader).paths[0])
        return entry.kind if entry else ""

    assert kind(assigned=True) == "property"
    assert kind(called=True) == "function"


@pytest.mark.parametrize("name", ["locaton", "material", "q"])
def test_nothing_is_looked_for_that_is_misspelt_or_near_or_says_nothing(
    name: str, searcher: Searcher, reader: BaseReader
) -> None:
    assert meant("Object", name, searcher, reader).paths == ()


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("Light.intensity", "PointLight.energy"),
        ("light.data.intensity = 500", "PointLight.energy"),
        ("bpy.context.object.position.x = 2", "Object.location"),
        (
            "AttributeError: 'RigidBodyObject' object has no attribute 'bounciness'",
            "RigidBodyObject.restitution",
        ),
        ("Mesh.polys", "Mesh.polygons"),  # short for it
    ],
)
def test_it_comes_first_and_is_named_above(query: str, first: str, kb: KnowledgeBase) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == T + first
    assert any("has no" in note and f"`{T}{first}`" in note for note in answer.notes)


def test_what_is_called_like_a_variable_may_be_meant_behind_what_has_the_name(kb: KnowledgeBase) -> None:
    answer = kb.query("node.position = (-300, 200)")
    assert f"{T}Node.location" in [hit.id for hit in answer.hits[:2]]
    assert any(note.startswith("If `node` is one of these") for note in answer.notes)


@pytest.mark.parametrize(
    ("owner", "written", "meant"),
    [
        ("SubsurfModifier", "level", "levels"),
        ("CameraDOFSettings", "focal_distance", "focus_distance"),
        ("DynamicPaintSurface", "use_antialias", "use_antialiasing"),
    ],
)
def test_what_can_only_be_misspelt_comes_before_its_class(
    owner: str, written: str, meant: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(f"AttributeError: '{owner}' object has no attribute '{written}'")
    assert answer.hits[0].id == f"bpy.types.{owner}.{meant}"
