"""Of things that a question compares, each is told."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.asked.sides import sides_of

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."


def test_the_sides_share_what_kind_they_are_of() -> None:
    assert [side.text for side in sides_of("lattice vs mesh deform modifier")] == [
        "lattice modifier",
        "mesh deform modifier",
    ]
    assert [side.text for side in sides_of("what is the difference between a point and a sun light?")] == [
        "a point light",
        "a sun light",
    ]


@pytest.mark.parametrize(
    "question",
    [
        "a film of 24 frames",
        'obj["a"] vs obj["b"]',
        "how does the liquid of one domain flow vs how it flows in another",
        "a vs b vs c vs d",
    ],
)
def test_other_questions_have_none(question: str) -> None:
    assert not sides_of(question)


@pytest.mark.parametrize(
    ("question", "things"),
    [
        ("lattice vs mesh deform modifier", ["LatticeModifier", "MeshDeformModifier"]),
        ("voronoi texture versus noise texture node", ["ShaderNodeTexVoronoi", "ShaderNodeTexNoise"]),
        ("difference between point light and area light", ["PointLight", "AreaLight"]),
        ("sample nearest surface vs sample index", ["GeometryNodeSampleNearestSurface", "GeometryNodeSampleIndex"]),
    ],
)  # fmt: skip
def test_each_is_described_before_more_is_told_of_any(
    question: str, things: list[str], kb: KnowledgeBase
) -> None:
    answer = kb.query(question)
    headings = [line for line in answer.text.split("\n") if line.startswith("## ")]
    assert headings == [f"## `{T}{thing}`" for thing in things]
    assert [hit.id for hit in answer.hits[:2]] == [T + thing for thing in things]


@pytest.mark.parametrize(
    ("question", "first"),
    [
        # Members of one class stand in one answer.
        ("subsurf levels vs render_levels", "SubsurfModifier.render_levels"),
        ("eevee vs cycles", ""),
        ("apply vs bake", ""),
    ],
)
def test_what_is_no_other_thing_or_is_not_clear_is_answered_as_ever(
    question: str, first: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(question)
    assert len([line for line in answer.text.split("\n") if line.startswith("## ")]) == 1
    assert not first or answer.hits[0].id == T + first
