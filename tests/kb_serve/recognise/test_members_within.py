"""What a class lacks is told where it is one step on: on its parts, its elements, or what it is the data of."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.elsewhere.members_within import members_within

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

T = "bpy.types."
FOUND = {
    ("SpaceView3D", "show_overlays"): (".overlay.show_overlays", "View3DOverlay.show_overlays"),
    ("Object", "vertices"): (".data.vertices", "Mesh.vertices"),
    ("FCurve", "interpolation"): (".keyframe_points[0].interpolation", "Keyframe.interpolation"),
    ("ViewLayer", "active"): (".objects.active", "LayerObjects.active"),
    ("Material", "inputs"): (".node_tree.nodes[0].inputs", "Node.inputs"),
    ("Mesh", "co"): (".vertices[0].co", "MeshVertex.co"),
    ("Camera", "location"): ("obj.location", "Object.location"),
    ("Bone", "constraints"): ("this is its `.bone`", "PoseBone.constraints"),
    ("Text", "body"): (".lines[0].body", "TextLine.body"),
    ("Key", "value"): (".key_blocks[0].value", "ShapeKey.value"),
    ("ClothSettings", "distance_min"): (".collision_settings", "ClothCollisionSettings.distance_min"),
    ("SoftBodySettings", "point_cache"): ("this is its `.settings`", "SoftBodyModifier.point_cache"),
    ("RenderSettings", "frame_start"): ("this is its `.render`", "Scene.frame_start"),
    ("RigidBodyWorld", "gravity"): ("this is its `.rigidbody_world`", "Scene.gravity"),
}


@pytest.mark.parametrize(("owner", "name"), FOUND)
def test_the_very_name_is_found_one_step_on(kb: KnowledgeBase, owner: str, name: str) -> None:
    access, path = FOUND[owner, name]
    answer = kb.query(f"AttributeError: '{owner}' object has no attribute '{name}'")
    assert answer.hits[0].id == f"{T}{path}"
    assert access in "\n".join(answer.notes)
    assert "Closest" not in "\n".join(answer.notes)


@pytest.mark.parametrize(
    ("owner", "name"),
    [
        ("PoseBone", "select_set"),
        ("AreaLight", "width"),  # at which each node of its tree is drawn
        ("RenderSettings", "width"),  # of a baked image
        ("ParticleSettings", "object"),  # of a texture's coordinates
        ("Object", "translate"),  # a pose's bone
        ("ShaderNodeTexImage", "reload"),
        ("EffectorWeights", "strength"),
        ("Scene", "lens"),
        ("RigidBodyObject", "damping"),  # of the object's collision, which is another thing
        ("SceneEEVEE", "samples"),
        ("Object", "empty_display_sizes"),
        ("Collection", "select_set"),
    ],
)
def test_what_is_another_thing_has_no_part_in_it(reader: BaseReader, owner: str, name: str) -> None:
    """The object that is a bone's shape, a scene's camera, a collection's objects, what is said of the same for another
    use.
    """
    assert members_within(f"{T}{owner}", name, reader) == []


@pytest.mark.parametrize(
    ("written", "path"),
    [
        ("bpy.data.objects.location", "Object.location"),
        ("bpy.context.selected_objects.location", "Object.location"),
        ("bpy.data.materials['M'].node_tree.nodes.label", "Node.label"),
    ],
)
def test_what_a_collection_lacks_its_elements_have(kb: KnowledgeBase, written: str, path: str) -> None:
    answer = kb.query(written)
    assert answer.hits[0].id == f"{T}{path}"
    assert "The elements of `." in "\n".join(answer.notes)


@pytest.mark.parametrize(
    ("written", "path"),
    [
        ("AttributeError: 'Object' object has no attribute 'locatoin'", "Object.location"),  # misspelt
        ("AttributeError: 'Light' object has no attribute 'power'", "PointLight.energy"),  # labelled so
        ("obj.material = mat", "Object.active_material"),  # of its elements the one that is meant
    ],
)
def test_what_is_meant_of_the_class_itself_comes_first(kb: KnowledgeBase, written: str, path: str) -> None:
    assert kb.query(written).hits[0].id == f"{T}{path}"


def test_a_shortened_name_is_the_closest(kb: KnowledgeBase) -> None:
    (note,) = kb.query("AttributeError: 'BMFace' object has no attribute 'vertices'").notes
    assert note.endswith("Closest: `bmesh.types.BMFace.verts`.")


@pytest.mark.blender
def test_blender_has_what_is_told_where_it_is_told() -> None:
    bpy = pytest.importorskip("bpy")
    mesh = bpy.data.meshes.new("new")
    mesh.from_pydata([(0, 0, 0)], [], [])
    obj = bpy.data.objects.new("new", mesh)
    key = obj.shape_key_add(name="Basis")
    text = bpy.data.texts.new("new")
    curve = obj.driver_add("location", 0)
    curve.keyframe_points.add(1)
    material = bpy.data.materials.new("new")
    had = {
        "vertices": obj.data, "co": mesh.vertices[0], "value": mesh.shape_keys.key_blocks[0],
        "body": text.lines[0], "interpolation": curve.keyframe_points[0],
        "inputs": material.node_tree.nodes[0], "active": bpy.context.view_layer.objects,
    }  # fmt: skip
    lacking = {
        "vertices": obj, "co": mesh, "value": mesh.shape_keys, "body": text, "interpolation": curve,
        "inputs": material, "active": bpy.context.view_layer,
    }  # fmt: skip
    assert key.value == mesh.shape_keys.key_blocks[0].value
    for name, thing in had.items():
        assert hasattr(thing, name)
        assert not hasattr(lacking[name], name)


@pytest.mark.parametrize(
    ("owner", "name", "path"),
    [
        ("ShaderNodeTexNoise", "scale", 'ShaderNodeTexNoise.inputs["Scale"]'),
        ("GeometryNodeRepeatOutput", "iterations", 'GeometryNodeRepeatInput.inputs["Iterations"]'),
    ],
)
def test_an_input_of_a_node_comes_before_what_its_parts_have(
    kb: KnowledgeBase, owner: str, name: str, path: str
) -> None:
    answer = kb.query(f"AttributeError: '{owner}' object has no attribute '{name}'")
    assert answer.hits[0].id == f"{T}{path}"
    assert "has it" not in "\n".join(answer.notes)


@pytest.mark.parametrize(
    ("query", "first", "how"),
    [
        (
            "AttributeError: 'BMLoop' object has no attribute 'uv'",
            "bmesh.types.BMLoopUV.uv",
            "`layer = bm.loops.layers.uv.verify()` before, then `loop[layer].uv`",
        ),
        (
            "bm.verts[0].deform",
            "bmesh.types.BMLayerAccessVert.deform",
            "`layer = bm.verts.layers.deform.verify()` before, then `vert[layer]`",
        ),
    ],
)
def test_what_elements_of_a_bmesh_have_in_layers(kb: KnowledgeBase, query: str, first: str, how: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    assert any(how in note for note in answer.notes)
