"""Keys that sockets lack, asked together with the node's name as Blender shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.messages.labelled_nodes import sockets_of_labelled_nodes

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_RAW = "KeyError: 'bpy_prop_collection[key]: key \"{}\" not found'"


@pytest.mark.parametrize(
    ("query", "first"),
    [
        (
            f"{_RAW.format('Density')} on Distribute Points on Faces",
            'GeometryNodeDistributePointsOnFaces.inputs["Density"]',
        ),
        ('KeyError key "Depth" not found render layers node', 'CompositorNodeRLayers.outputs["Depth"]'),
        (f"{_RAW.format('Mesh')} (mesh boolean node)", 'GeometryNodeMeshBoolean.outputs["Mesh"]'),
    ],
)
def test_the_socket_of_the_named_node_comes_first(query: str, first: str, kb: KnowledgeBase) -> None:
    assert kb.query(query).hits[0].id == f"bpy.types.{first}"


def test_the_side_that_is_asked_for_comes_first(kb: KnowledgeBase) -> None:
    both = sockets_of_labelled_nodes("Geometry", "outputs of Set Position", kb.reader)
    assert [path.rpartition(".")[2] for path in both] == ['outputs["Geometry"]', 'inputs["Geometry"]']


@pytest.mark.parametrize("query", ["a node group", "Set Position", "modifier of an object"])
def test_without_the_name_of_a_node_that_has_it_nothing_is_found(query: str, kb: KnowledgeBase) -> None:
    assert sockets_of_labelled_nodes("Density", query, kb.reader) == []
