"""Members of a class that words beside its name describe."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.by_words import members_by_words

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("ParticleSettings brownian", "bpy.types.ParticleSettings.brownian_factor"),
        ("BevelModifier limit angel", "bpy.types.BevelModifier.angle_limit"),
        ("MovieTrackingTrack marker pattern corners", "bpy.types.MovieTrackingMarker.pattern_corners"),
    ],
)
def test_the_one_member_that_all_words_describe_comes_first(
    kb: KnowledgeBase, query: str, first: str
) -> None:
    assert kb.query(query).hits[0].id == first


@pytest.mark.parametrize(
    "query", ["ClothSettings stiffness", "CyclesRenderSettings denoising", "ParticleSettings"]
)
def test_where_several_are_described_the_class_shows_them(kb: KnowledgeBase, query: str) -> None:
    assert kb.query(query).hits[0].id == f"bpy.types.{query.split()[0]}"


def test_a_question_is_not_about_a_member_because_it_names_a_class(kb: KnowledgeBase) -> None:
    answer = kb.query("ParticleSettings of hair that should follow the surface of a moving mesh")
    assert answer.hits[0].id != "bpy.types.ParticleSettings.brownian_factor"


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("wm.obj_export(filepath=path)", "bpy.ops.wm.obj_export"),
        ("object.shade_smooth()", "bpy.ops.object.shade_smooth"),
        ("image.save()", "bpy.types.Image.save"),  # a method before the operator
        ("Vector.to_track", "mathutils.Vector.to_track_quat"),
        ("BMVert.link_edge", "bmesh.types.BMVert.link_edges"),
    ],
)
def test_short_ways_to_write_a_module_are_read(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    assert not [note for note in answer.notes if "WindowManager" in note or "Node" in note]


def test_what_words_mean_is_not_remembered_for_ever() -> None:
    assert members_by_words._means.cache_info().maxsize is not None


@pytest.mark.parametrize(
    ("query", "named"),
    [
        ("ShaderNodeBsdfPrincipled inputs Coat", ["Coat Weight", "Coat Roughness", "Coat IOR"]),
        ("ShaderNodeTexNoise inputs Scale Detail", ["Scale", "Detail"]),
        ("GeometryNodeCurveToMesh input Profile", ["Profile Curve"]),
    ],
)
def test_words_beside_a_node_name_its_sockets(kb: KnowledgeBase, query: str, named: list[str]) -> None:
    ids = [hit.id for hit in kb.query(query).hits]
    node = f"bpy.types.{query.split()[0]}"
    assert ids[0].startswith(node)
    assert [one for one in ids if "[" in one][: len(named)] == [f'{node}.inputs["{name}"]' for name in named]


def test_a_word_beside_a_node_is_no_member_of_all_sockets(kb: KnowledgeBase) -> None:
    ids = [hit.id for hit in kb.query("ShaderNodeBsdfPrincipled inputs Coat").hits]
    assert "bpy.types.NodeSocket.is_multi_input" not in ids
