"""What a variable is whose class its name does not tell, by what is read of it and what it is set to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."


@pytest.mark.parametrize(
    ("query", "meant"),
    [
        ('voronoi.inputs["Randomness"].default_value = 1.0', 'ShaderNodeTexVoronoi.inputs["Randomness"]'),
        ('checker.inputs["Scale"].default_value = 4', 'ShaderNodeTexChecker.inputs["Scale"]'),
        ('output.inputs["Surface"]', 'ShaderNodeOutputMaterial.inputs["Surface"]'),
        ('noise_tex.inputs["W"].default_value = 2', 'ShaderNodeTexNoise.inputs["W"]'),
        ('brick.inputs["Color1"]', 'ShaderNodeTexBrick.inputs["Color1"]'),
        ("math.operation = 'MULTIPLY'", "ShaderNodeMath.operation"),
        ("voronoi.feature = 'F1'", "ShaderNodeTexVoronoi.feature"),
        ("magic.turbulence_depth = 3", "ShaderNodeTexMagic.turbulence_depth"),
        ("ramp.color_ramp.elements[0].color = (1, 1, 1, 1)", "ColorRampElement.color"),
        (
            "b = nt.nodes.new(\"ShaderNodeBsdfGlossy\")\nb.distribution = 'BECKMANN'",
            "ShaderNodeBsdfAnisotropic.distribution",  # the name of today
        ),
        (
            "s = g.interface.new_socket('N', in_out='INPUT', socket_type='NodeSocketInt')\ns.default_value = 3",
            "NodeTreeInterfaceSocketInt.default_value",
        ),
        ("group.add([0], 1.0, 'ADD')", "VertexGroup.add"),
        ('ramp.inputs["Fac"]', 'ShaderNodeValToRGB.inputs["Factor"]'),
        ('cr.outputs["Color"]', 'ShaderNodeValToRGB.outputs["Color"]'),
        ("strip.channelbag(slot, ensure=True)", "ActionKeyframeStrip.channelbag"),
        ("socket.structure_type = 'FIELD'", "NodeTreeInterfaceSocket.structure_type"),
        ("strips.new_image(name='a', filepath='b', channel=1, frame_start=1)", "StripsTopLevel.new_image"),
    ],
)
def test_a_variable_is_of_the_class_that_is_called_so_and_has_the_member(
    query: str, meant: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == f"{T}{meant}"
    assert "has no" not in "\n".join(answer.notes)


def test_what_a_socket_is_set_to_tells_the_node(kb: KnowledgeBase) -> None:
    value = "Count"
    taking = kb.query(f'node.inputs["Mode"].default_value = "{value}"').hits[0].id
    node, _, name = taking.removeprefix(T).partition(".inputs")
    tree = bpy.data.node_groups.new("g", "GeometryNodeTree")
    socket = tree.nodes.new(node).inputs[name.strip('["]')]
    socket.default_value = value
    assert socket.default_value == value


@pytest.mark.parametrize(
    ("query", "member"),
    [("bone.use_connect = True", "use_connect"), ("n.domain = 'FACE'", "domain")],
)
def test_what_is_assigned_can_be(query: str, member: str, kb: KnowledgeBase) -> None:
    found = kb.query(query).hits[0].id.removeprefix(T).removesuffix(f".{member}")
    assert not getattr(bpy.types, found).bl_rna.properties[member].is_readonly


def test_a_socket_that_no_node_has_is_not_a_trees(kb: KnowledgeBase) -> None:
    (note,) = kb.query('node.inputs["Bogus"].default_value = 1').notes
    assert note.startswith('`bpy.types.Node` has no `inputs["Bogus"]`')


@pytest.mark.parametrize("query", ["bm.verts.layers.shape['Key']", "bm.loops.layers.uv['UVMap']"])
def test_layers_of_a_bmesh_are_found_by_name(query: str, kb: KnowledgeBase) -> None:
    assert "no custom properties" not in kb.query(query).text
    assert kb.query(f"{query}.name").hits[0].id == "bmesh.types.BMLayerItem.name"


@pytest.mark.parametrize(
    ("query", "meant"),
    [
        ("Euler((0.1, 0.2, 0.3), 'XYZ')", "mathutils.Euler"),
        ("Vector((1, 2, 3))", "mathutils.Vector"),
        ("sequencer_scene", "bpy.types.Context.sequencer_scene"),
        ("active_object", "bpy.types.Context.active_object"),
        ("particle_system", "bpy.types.ParticleSystem"),
        ("bpy.ops.mesh.merge_by_distance()", "bpy.ops.mesh.remove_doubles"),
        ("me.edge_creases_ensure().data[0].value = 1", "bpy.types.Mesh.edge_creases_ensure"),
    ],
)
def test_what_is_named_comes_before_what_it_holds_and_what_resembles_it(
    query: str, meant: str, kb: KnowledgeBase
) -> None:
    assert kb.query(query).hits[0].id == meant


def test_a_constraint_of_a_bone_is_of_the_class_that_it_is_made_as(kb: KnowledgeBase) -> None:
    answer = kb.query("c = pb.constraints.new('DAMPED_TRACK')\nc.track_axis = '-Z'")
    assert answer.hits[0].id == f"{T}DampedTrackConstraint.track_axis"
    (note,) = answer.notes
    assert note.endswith("Closest: `'TRACK_NEGATIVE_Z'`.")
