"""Sockets that questions ask of nodes which they call by their labels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("question", "first"),
    [
        ("Set Position node offset input", 'GeometryNodeSetPosition.inputs["Offset"]'),
        (
            "what is the input called for detail on the Noise Texture node",
            'ShaderNodeTexNoise.inputs["Detail"]',
        ),
        (
            "Instance on Points node scale and rotation inputs",
            'GeometryNodeInstanceOnPoints.inputs["Rotation"]',
        ),
    ],
)
def test_the_socket_of_a_node_comes_first(kb: KnowledgeBase, question: str, first: str) -> None:
    answer = kb.query(question)
    assert f"bpy.types.{first}" in [hit.id for hit in answer.hits][:3]
    assert answer.hits[0].id.startswith(f"bpy.types.{first.split('.')[0]}")


def test_a_socket_that_was_renamed_is_told_with_the_new_one(kb: KnowledgeBase) -> None:
    answer = kb.query("Principled BSDF clearcoat input")
    assert answer.hits[0].id == 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Coat Weight"]'
    assert any("removed in 4.0" in note for note in answer.notes)


def test_a_question_about_all_sockets_is_no_question_about_one(kb: KnowledgeBase) -> None:
    assert "[" not in kb.query("Principled BSDF inputs list").hits[0].id


@pytest.mark.parametrize(
    ("question", "first"),
    [
        (
            "how do I connect image texture alpha output to principled bsdf alpha input",
            "bpy.types.NodeLinks.new",
        ),
    ],
)
def test_a_question_about_links_is_no_question_about_one(
    kb: KnowledgeBase, question: str, first: str
) -> None:
    assert kb.query(question).hits[0].id == first
