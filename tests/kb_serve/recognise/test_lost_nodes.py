"""Nodes that other versions alone have, by what people call them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.named.lost_nodes import lost_nodes

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("question", "lost"),
    [
        ("musgrave node", ["ShaderNodeTexMusgrave"]),  # of textures' trees there is one yet
        ("a musgrave texture node", ["ShaderNodeTexMusgrave"]),
        ("separate rgb node", ["ShaderNodeSeparateRGB"]),
        ("composite node", ["CompositorNodeComposite"]),
        ("voronoi texture node", []),  # which shaders have
        ("file output node", []),
        ("shader node", []),
    ],
)
def test_a_lost_node_is_known_by_the_words_before_it(
    question: str, lost: list[str], kb: KnowledgeBase
) -> None:
    found = [path.rpartition(".")[2] for path in lost_nodes(question.split(), kb.reader)]
    assert found[: len(lost) or None] == lost


def test_a_node_that_is_gone_is_told_rather_than_the_page_that_is_called_so(kb: KnowledgeBase) -> None:
    answer = kb.query("musgrave node")
    assert "ShaderNodeTexMusgrave` does not exist" in answer.notes[0]
    assert answer.hits[0].id == "bpy.types.ShaderNodeTexNoise"
