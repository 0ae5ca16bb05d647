"""What a question asks for beside its best hit is listed too, and takes nothing's place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.rank.merging import QueryRanker

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

TYPES = "bpy.types."


def ids(kb: KnowledgeBase, question: str) -> list[str]:
    return [hit.id for hit in kb.query(question).hits]


@pytest.mark.parametrize(
    ("question", "wanted"),
    [
        (
            "point light soft size and shadow jitter",
            ["PointLight.shadow_soft_size", "PointLight.use_shadow_jitter"],
        ),
        ("wave modifier height, speed and narrowness", ["WaveModifier.height", "WaveModifier.speed"]),
        (
            "hook modifier falloff radius and strength",
            ["HookModifier.falloff_radius", "HookModifier.strength"],
        ),
        ("limits of a shape key's slider", ["ShapeKey.slider_min", "ShapeKey.slider_max"]),
    ],
)
def test_members_of_one_class_are_listed_together(
    kb: KnowledgeBase, question: str, wanted: list[str]
) -> None:
    text = kb.query(question).text
    assert [name for name in wanted if name not in text and f"`.{name.partition('.')[2]}`" not in text] == []


@pytest.mark.parametrize(
    ("question", "node"),
    [
        ("noise texture with mapping and color ramp nodes", "ShaderNodeMapping"),
        ("use an attribute node to read vertex weights", "ShaderNodeAttribute"),
    ],
)
def test_nodes_that_are_called_by_their_labels_are_listed(
    kb: KnowledgeBase, question: str, node: str
) -> None:
    assert f"{TYPES}{node}" in ids(kb, question)


def test_a_label_without_a_node_is_a_word_like_others(kb: KnowledgeBase) -> None:
    assert f"{TYPES}ShaderNodeMapping" not in ids(kb, "uv mapping and unwrapping of a cube")


def test_nodes_that_are_listed_besides_stand_behind_the_first_hits(kb: KnowledgeBase) -> None:
    question = "noise texture with mapping and color ramp nodes"
    ranked = QueryRanker(kb.reader).rank(question).ranked
    reasons = [row.why for row in ranked]
    assert "beside" in reasons
    assert "beside" not in reasons[:5]
    assert len({row.id for row in ranked}) == len(ranked)


def test_of_a_class_that_is_named_what_is_asked_for_comes_before_all_that_it_has(kb: KnowledgeBase) -> None:
    text = kb.query("line art modifier source collection, target layer and material").text
    asked, _, rest = text.partition("**Asked for**\n")[2].partition("\n\n")
    names = {line.partition("`")[2].partition("`")[0] for line in asked.splitlines()}
    assert names == {"source_collection", "target_layer", "target_material"}
    assert "**Properties**" in rest


def test_a_message_asks_for_nothing_besides(kb: KnowledgeBase) -> None:
    message = "TypeError: the Mapping node expected a float type, not str"
    assert "beside" not in {row.why for row in QueryRanker(kb.reader).rank(message).ranked}


def test_a_class_in_the_list_says_how_one_is_made(kb: KnowledgeBase) -> None:
    text = kb.query("keep the camera pointed at an empty with a constraint").text
    assert "— made by `obj.constraints.new('" in text


@pytest.mark.parametrize(
    ("question", "first"),
    [
        ("matrix decompose location rotation scale", "mathutils.Matrix.decompose"),
        ("driver scripted expression with variable from another object", f"{TYPES}Driver.expression"),
        ("delete object without operators", f"{TYPES}BlendDataObjects.remove"),
        ("hide an object without deleting it", f"{TYPES}Object.hide_viewport"),
    ],
)
def test_a_name_that_is_said_with_its_owners_comes_first(
    kb: KnowledgeBase, question: str, first: str
) -> None:
    assert ids(kb, question)[0] == first


@pytest.mark.parametrize(
    ("question", "node"),
    [
        ("how to add a voronoi texture", "ShaderNodeTexVoronoi"),
        ("how to mix two shaders", "ShaderNodeMixShader"),
        ("sky texture world", "ShaderNodeTexSky"),
    ],
)
def test_a_node_whose_label_is_said_comes_before_pages_about_others(
    question: str, node: str, kb: KnowledgeBase
) -> None:
    assert kb.query(question).hits[0].id == f"bpy.types.{node}"


def test_what_is_done_without_comes_last(kb: KnowledgeBase) -> None:
    found = ids(kb, "point the camera at an object without a constraint")
    assert "mathutils.Vector.to_track_quat" in found
    assert not any("onstraint" in one for one in found)
