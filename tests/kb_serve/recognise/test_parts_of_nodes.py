"""Keys that name nodes, or sockets that nodes have only with some setting."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.messages.parts_of_nodes import nodes_called, sockets_by_setting

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_RAW = "KeyError: 'bpy_prop_collection[key]: key \"{}\" not found'"
_T = "bpy.types."


@pytest.mark.parametrize(
    ("query", "first", "told"),
    [
        (
            _RAW.format("Principled BSDF"),
            "ShaderNodeBsdfPrincipled",
            'n.bl_idname == "ShaderNodeBsdfPrincipled"',
        ),
        (_RAW.format("Image Texture.001"), "ShaderNodeTexImage", 'is called "Image Texture"'),
        (f'nodes["Mix"] {_RAW.format("Mix")}', "ShaderNodeMix", '`tree.nodes.new("ShaderNodeMix")`'),
        (
            _RAW.format("Depth"),
            'CompositorNodeRLayers.outputs["Depth"]',
            "only with `view_layer.use_pass_z=True`",
        ),
        (_RAW.format("Mist"), 'CompositorNodeRLayers.outputs["Mist"]', "view_layer.use_pass_mist=True"),
    ],
)
def test_a_key_leads_to_the_node_or_socket_that_has_the_name(
    query: str, first: str, told: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == f"{_T}{first}"
    assert any(told in note for note in answer.notes)


@pytest.mark.parametrize(
    ("name", "query"),
    [
        ("Mix", ""),  # of one word, it may be the name of anything
        ("Cube", 'bpy.data.objects["Cube"]'),
        ("My Material", "nodes"),
        ("Icosphere", ""),  # what an object is called
    ],
)
def test_a_name_of_anything_is_no_nodes(name: str, query: str, kb: KnowledgeBase) -> None:
    assert nodes_called(name, f"{query} {_RAW.format(name)}", kb.reader) == []


@pytest.mark.parametrize("name", ["ColorRamp", "color ramp"])
def test_a_name_without_its_spaces_or_capitals_is_meant(name: str, kb: KnowledgeBase) -> None:
    answer = kb.query(_RAW.format(name))
    assert f"{_T}ShaderNodeValToRGB" in {hit.id for hit in answer.hits[:2]}
    assert any('is called "Color Ramp"' in note for note in answer.notes)


def test_a_modifiers_name_is_no_nodes(kb: KnowledgeBase) -> None:
    answer = kb.query(f'ob.modifiers["Volume to Mesh"] {_RAW.format("Volume to Mesh")}')
    assert not any("tree.nodes" in note for note in answer.notes)


def test_a_socket_that_its_node_always_has_by_that_name_needs_no_setting(kb: KnowledgeBase) -> None:
    owners = {socket.owner for socket in sockets_by_setting("Value", kb.reader)}
    assert f"{_T}ShaderNodeVectorMath" in owners
    assert f"{_T}FunctionNodeRandomValue" not in owners
    assert sockets_by_setting("Roughness", kb.reader) == []


def test_a_socket_that_was_renamed_comes_before_one_that_a_setting_brings(kb: KnowledgeBase) -> None:
    answer = kb.query(_RAW.format("Transmission"))
    assert answer.hits[0].id == f'{_T}ShaderNodeBsdfPrincipled.inputs["Transmission Weight"]'
    assert not any("is there only with" in note for note in answer.notes)


@pytest.mark.blender
def test_new_nodes_are_called_as_is_said_and_passes_bring_outputs(kb: KnowledgeBase) -> None:
    bpy = pytest.importorskip("bpy")
    material = bpy.data.materials.new("made")
    for label in ("Principled BSDF", "Image Texture", "Color Ramp", "Mix"):
        (node, *_) = nodes_called(label, "nodes", kb.reader)
        material.node_tree.nodes.clear()
        assert material.node_tree.nodes.new(node.name).name == label
    scene = bpy.data.scenes.new("rendered")
    tree = bpy.data.node_groups.new("composed", "CompositorNodeTree")
    layers = tree.nodes.new("CompositorNodeRLayers")
    layers.scene = scene
    assert layers.outputs.get("Depth") is None
    scene.view_layers[0].use_pass_z = True
    assert layers.outputs["Depth"].name == "Depth"
