"""Names like those of Blender's own nodes that none has: the nodes that are meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.named.node_names import is_like_a_node, nodes_meant

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("ShaderNodeBSDFGlass", ["ShaderNodeBsdfGlass"]),  # by its letters
        ("GeometryNodeMath", ["ShaderNodeMath"]),  # of another family, which the tree takes
        ("GeometryNodeTransformGeometry", ["GeometryNodeTransform"]),  # by its label
        ("GeometryNodeSetPositions", ["GeometryNodeSetPosition"]),  # misspelt
        ("ShaderNodeGlass", ["ShaderNodeBsdfGlass"]),  # with a word more
        ("GeometryNodeMeshPrimitiveCube", ["GeometryNodeMeshCube"]),  # with a word less
        ("GeometryNodeScatter", []),  # what a shader scatters is none of geometry
    ],
)
def test_nodes_are_meant_by_what_is_said_behind_the_family(
    name: str, meant: list[str], kb: KnowledgeBase
) -> None:
    assert [path.rpartition(".")[2] for path in nodes_meant(name, kb.reader)] == meant


def test_those_with_the_fewest_words_more_come_first(kb: KnowledgeBase) -> None:
    assert nodes_meant("GeometryNodeJoin", kb.reader)[0] == "bpy.types.GeometryNodeJoinGeometry"


@pytest.mark.parametrize("name", ["ShaderNode", "ShaderNodeTree", "GeometryNodeTree", "NodeFrame", "Glass"])
def test_classes_of_families_and_trees_are_not_like_a_node(name: str) -> None:
    assert not is_like_a_node(name)


@pytest.mark.parametrize(
    "query",
    [
        "ShaderNodeGlass",
        "RuntimeError: Error: Node type ShaderNodeGlass undefined",
        "nodes.new('ShaderNodeGlass')",
        "mat.node_tree.nodes.new(type='ShaderNodeGlass')",
    ],
)
def test_answers_name_the_node_in_place_of_one_that_never_was(query: str, kb: KnowledgeBase) -> None:
    (note,) = kb.query(query).notes
    assert "`ShaderNodeGlass`" in note
    assert note.rstrip(".`").endswith("ShaderNodeBsdfGlass")


@pytest.mark.parametrize("query", ["nodes.new('ShaderNodeBsdfGlass')", "nodes.new('MyAddonNode')"])
def test_nothing_is_said_of_nodes_that_are_there_or_may_be(query: str, kb: KnowledgeBase) -> None:
    assert kb.query(query).notes == ()


def test_a_node_of_another_blender_is_told_of_once(kb: KnowledgeBase) -> None:
    (note,) = kb.query("nodes.new('ShaderNodeTexMusgrave')").notes
    assert "ShaderNodeTexNoise" in note
