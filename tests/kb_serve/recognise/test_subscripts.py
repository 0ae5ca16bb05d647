"""Text in brackets behind what is no collection is a custom property, or an input of a geometry-nodes modifier."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from other_versions import base_of
from told_by_blender import told_by_blender

from kb_build.symbols.api_names import TYPES
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.reader import BaseReader
from kb_serve.recognise.chains.subscripts import CustomProperties

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.mark.parametrize(
    "query",
    [
        'modifier["Socket_2"] = 5.0',
        'obj.modifiers["GeometryNodes"]["Input_2"] = 5.0',
        'mod["Socket_2"]',
        'm["Socket_2"] = 2.0',
        'whatever["Input_3_use_attribute"] = True',
        "how do I set a geometry nodes modifier input value from Python",
        "change the value of an input of a geometry nodes modifier from python",
        "How do I set a geometry nodes modifier's input?",
        "set the Size parameter of my geometry nodes",
        "animate a geometry node modifier's slider",
    ],
)
def test_inputs_of_a_geometry_nodes_modifier_are_set_by_identifier(kb: KnowledgeBase, query: str) -> None:
    notes = "\n".join(kb.query(query).notes)
    assert 'modifier[modifier.node_group.interface.items_tree["Size"].identifier] = 5.0' in notes
    assert "A menu takes the number of an entry, which is not its index" in notes
    assert "has no" not in notes


@pytest.mark.blender
@pytest.mark.parametrize(
    "query",
    [
        'm["Socket_2"] = 2.0',
        'obj.modifiers["GeometryNodes"]["Input_2"] = 5.0',
        'm.properties["Socket_2"] = 2.0',
        "getattr(mod.properties.inputs, item.identifier).keyframe_insert('value', frame=1)",
        "AttributeError: 'NodesModifierProperties' object has no attribute 'Socket_1'",
        "how do I set a geometry nodes modifier input value from Python",
        "TypeError: bpy_struct[key] = val: id properties not supported for this type",
        "TypeError: this type doesn't support IDProperties",
    ],
)
def test_inputs_that_are_properties_are_told_as_such(query: str) -> None:
    with KnowledgeBase(base_of("5.2")) as kb:
        notes = "\n".join(kb.query(query).notes)
    assert "`modifier.properties.inputs.Socket_2.value" in notes
    assert "geometry-nodes modifiers take" not in notes
    assert "has no" not in notes


@pytest.mark.parametrize(
    "query",
    [
        "add an input to a geometry nodes modifier",
        "set a value of the array modifier",
    ],
)
def test_inputs_are_not_told_of_where_others_are_asked_for(kb: KnowledgeBase, query: str) -> None:
    assert not any("Inputs of a geometry-nodes modifier" in note for note in kb.query(query).notes)


def test_inputs_are_told_of_where_the_modifier_is_the_answer(kb: KnowledgeBase) -> None:
    answer = kb.query("geometry nodes")  # the manual would tell more of it, but is not in this base
    assert answer.hits[0].id == f"{TYPES}NodesModifier"
    assert any("Inputs of a geometry-nodes modifier" in note for note in answer.notes)
    assert "bpy.types.GeometryNodeTree" in [hit.id for hit in answer.hits]


@pytest.mark.parametrize(
    "query",
    ["add an input to a geometry nodes modifier", "create a new slider on my geometry nodes modifier"],
)
def test_new_inputs_of_a_geometry_nodes_modifier_are_those_of_its_group(
    kb: KnowledgeBase, query: str
) -> None:
    assert kb.query(query).hits[0].id == "bpy.types.NodeTreeInterface.new_socket"


@pytest.mark.parametrize(
    ("query", "cls"),
    [
        ('scene["my_prop"] = 3', "Scene"),
        ('obj["health"]', "Object"),
        ('pose.bones["Arm"]["ik_fk"]', "PoseBone"),
    ],
)
def test_a_custom_property_is_no_attribute(kb: KnowledgeBase, query: str, cls: str) -> None:
    (note,) = kb.query(query).notes
    assert f"is a custom property of `bpy.types.{cls}`" in note
    assert "registered by `bpy.props` is not found in brackets since Blender 5.0" in note


_INSTANCES = """
import json, sys
import bpy

ob = bpy.context.object
bpy.data.materials.new("m").asset_mark()
rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
bpy.context.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
edit_bone = rig.data.edit_bones.new("b")
edit_bone.tail = 0, 0, 1
takes = {}

def try_it(*instances):
    for one in instances:
        try:
            one["a"] = 1
            takes[type(one).bl_rna.identifier] = True
        except TypeError:
            takes[type(one).bl_rna.identifier] = False

try_it(edit_bone)
bpy.ops.object.mode_set(mode="OBJECT")
tree = bpy.data.node_groups.new("g", "GeometryNodeTree")
node = tree.nodes.new("ShaderNodeMath")
preferences = next(one.preferences for one in bpy.context.preferences.addons if one.preferences)
strips = bpy.context.scene.sequence_editor_create().strips
try_it(
    ob, node, node.inputs[0], bpy.data.materials["m"].asset_data, rig.data.bones[0], rig.pose.bones[0],
    rig.data.collections.new("c"), ob.modifiers.new("n", "NODES"), ob.modifiers.new("w", "WAVE"), preferences,
    strips.new_effect("c", "COLOR", 1, 1, length=5), bpy.context.view_layer, bpy.context.scene.render,
    ob.constraints.new("COPY_LOCATION"), bpy.context.scene.timeline_markers.new("m"),
)
open(sys.argv[-1], "w").write(json.dumps(takes))
"""


@pytest.fixture
def reader(base: Path) -> Iterator[BaseReader]:
    opened = BaseReader(base)
    yield opened
    opened.close()


def test_classes_take_custom_properties_where_blender_does(reader: BaseReader, tmp_path: Path) -> None:
    takes: dict[str, bool] = told_by_blender(_INSTANCES, tmp_path)
    assert {True, False} == set(takes.values())
    custom = CustomProperties(reader)
    known = {name for name in takes if reader.entry(TYPES + name)}
    assert len(known) > 12
    assert {name: custom.taken_by(TYPES + name) != [] for name in known} == {
        name: takes[name] for name in known
    }


def test_only_what_reads_a_custom_property_is_told_that_it_may_lack(kb: KnowledgeBase) -> None:
    for query, is_read in (('ob["p"] = 1.0', False), ('print(ob["p"])', True), ('ob["p"] += 1', True)):
        notes = "\n".join(kb.query(query).notes)
        assert "is a custom property of `bpy.types.Object`" in notes
        assert ("reading raises KeyError" in notes) is is_read, query


def test_a_property_that_is_registered_is_no_custom_one(kb: KnowledgeBase) -> None:
    notes = kb.query('scene["prop"] KeyError after registering with bpy.props').notes
    assert any("it is the attribute `.prop`" in note for note in notes)


def test_what_takes_no_custom_properties_says_so(kb: KnowledgeBase) -> None:
    answer = kb.query('obj.constraints["Copy Location"]["influence"] = 0.5')
    assert answer.hits[0].id == "bpy.types.Constraint.influence"
    assert "takes no custom properties" in answer.notes[0]


def test_a_variable_called_context_may_be_a_dictionary(kb: KnowledgeBase) -> None:
    answer = kb.query("context = bpy.context.copy(); context['object'] = ob")
    assert not any("custom properties" in note for note in answer.notes)


@pytest.mark.parametrize("query", ['bsdf.inputs["Base Color"] = (1, 0, 0, 1)', "n.inputs[0] = 3"])
def test_a_socket_is_set_by_its_value(kb: KnowledgeBase, query: str) -> None:
    assert [note for note in kb.query(query).notes if "is its `default_value`" in note]


@pytest.mark.parametrize(
    "query", ['bsdf.inputs["Base Color"].default_value = (1, 0, 0, 1)', "mod['Socket_2'] = 3"]
)
def test_the_value_of_a_socket_is_left_alone(kb: KnowledgeBase, query: str) -> None:
    assert not [note for note in kb.query(query).notes if "is its `default_value`" in note]


def test_limits_of_custom_properties_are_not_those_of_old(kb: KnowledgeBase) -> None:
    (note,) = kb.query("ob['_RNA_UI'] = {'size': {'min': 0.0}}").notes
    assert 'id_properties_ui("name").update(' in note
