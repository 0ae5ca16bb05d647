"""What is said to add or remove a collection's elements does so, in this environment's Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.recognise.elsewhere.elements import ADDED_BY, REMOVED_BY

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase

# Collection → (what it lacks, statements that add elements; their count before and after), then the same for removing.
_ADDED = {
    "LayerObjects.selected": ("bpy.context.view_layer.objects.selected", "other.select_set(True)", 1),
    "PointCloud.points": ("bpy.data.pointclouds[0].points", "bpy.data.pointclouds[0].resize(3)", 3),
    "Curves.curves": ("bpy.data.hair_curves[0].curves", "bpy.data.hair_curves[0].add_curves([4, 4])", 2),
    "Curves.points": ("bpy.data.hair_curves[0].points", "bpy.data.hair_curves[0].add_curves([4, 4])", 8),
    "BoidState.rules": (
        "psys.settings.boids.states[0].rules",
        "with bpy.context.temp_override(particle_settings=psys.settings): "
        "bpy.ops.boid.rule_add(type='FOLLOW_LEADER')",
        1,
    ),
    "DynamicPaintCanvasSettings.canvas_surfaces": (
        "canvas.canvas_surfaces",
        "bpy.context.view_layer.objects.active = ob; bpy.ops.dpaint.surface_slot_add()",
        1,
    ),
    "MovieTracking.plane_tracks": (
        "clip.tracking.plane_tracks",
        "in_clip_editor(bpy.ops.clip.create_plane_track)",
        1,
    ),
    "MovieTrackingObject.plane_tracks": (
        "clip.tracking.objects[0].plane_tracks",
        "in_clip_editor(bpy.ops.clip.create_plane_track)",
        1,
    ),
    "MovieTrackingStabilization.tracks": (
        "clip.tracking.stabilization.tracks",
        "in_clip_editor(bpy.ops.clip.stabilize_2d_add)",
        4,
    ),
    "ParticleSystem.targets": (
        "psys.targets",
        "with bpy.context.temp_override(particle_system=psys): bpy.ops.particle.new_target()",
        1,
    ),
    "DriverVariable.targets": ("variable.targets", "variable.type = 'LOC_DIFF'", 1),
    "Object.children": ("ob.children", "other.parent = ob", 1),
    "Object.users_collection": ("new.users_collection", "bpy.context.collection.objects.link(new)", 1),
    "Object.material_slots": ("ob.material_slots", "ob.data.materials.append(material)", 1),
    "Key.key_blocks": ("mesh.shape_keys.key_blocks", 'ob.shape_key_add(name="Key")', 1),
    "BlendData.shape_keys": ("bpy.data.shape_keys", 'other.shape_key_add(name="Key")', 1),
    "Armature.bones": ("armature.bones", "new_bone()", 1),
    "Pose.bones": ("rig.pose.bones", "new_bone()", 1),
    "Object.particle_systems": (
        "ob.particle_systems",
        "assert ob.modifiers.new(\"Particles\", 'PARTICLE_SYSTEM').particle_system",
        1,
    ),
    "Scene.objects": ("scene.objects", "bpy.context.collection.objects.link(new)", 1),
    "ViewLayer.objects": ("bpy.context.view_layer.objects", "bpy.context.collection.objects.link(new)", 1),
    "Collection.all_objects": ("scene.collection.all_objects", "bpy.context.collection.objects.link(new)", 1),
    "LayerCollection.children": (
        "bpy.context.view_layer.layer_collection.children",
        'scene.collection.children.link(bpy.data.collections.new("c"))',
        1,
    ),
    "MeshVertex.groups": (
        "mesh.vertices[0].groups",
        'ob.vertex_groups.new(name="Group"); ob.vertex_groups["Group"].add([0], 1.0, \'REPLACE\')',
        1,
    ),
    "NodeSocket.links": (
        "mixed.inputs[0].links",
        "node_tree.links.new(valued.outputs[0], mixed.inputs[0])",
        1,
    ),
    "Text.lines": ("text.lines", 'text.write("line\\n")', 1),
    "GreasePencilDrawing.strokes": ("drawing.strokes", "drawing.add_strokes([4])", 1),
}
# In a bmesh, a triangle loses one of its vertices.
_LOST = (
    "import bmesh; mesh = other.data; bm = bmesh.new(); bm.from_mesh(mesh); bm.verts.ensure_lookup_table(); "
    "bmesh.ops.delete(bm, geom=[bm.verts[0]], context='VERTS'); bm.to_mesh(mesh)"
)
_REMOVED = {
    "LayerObjects.selected": ("bpy.context.view_layer.objects.selected", "ob.select_set(False)", -1),
    "Object.children": ("weighted.children", "dusty.parent = None", -1),
    "Object.users_collection": (
        "other.users_collection",
        "bpy.context.collection.objects.unlink(other)",
        -1,
    ),
    "Object.material_slots": ("ob.material_slots", "remove_slots()", -1),
    "Key.key_blocks": (
        "mesh.shape_keys.key_blocks",
        'ob.shape_key_remove(ob.data.shape_keys.key_blocks["Top"])',
        -1,
    ),
    "Armature.bones": ("armature.bones", "remove_bone()", -1),
    "Pose.bones": ("rig.pose.bones", "remove_bone()", -1),
    "Object.particle_systems": (
        "dusty.particle_systems",
        'dusty.modifiers.remove(dusty.modifiers["Dust"])',
        -1,
    ),
    "Scene.objects": ("scene.objects", "bpy.data.objects.remove(other)", -1),
    "ViewLayer.objects": ("bpy.context.view_layer.objects", "bpy.data.objects.remove(other)", -1),
    "Collection.all_objects": (
        "scene.collection.all_objects",
        "bpy.context.collection.objects.unlink(other)",
        -1,
    ),
    "MeshVertex.groups": (
        "weighted.data.vertices[0].groups",
        'weighted.vertex_groups["Group"].remove([0])',
        -1,
    ),
    "NodeSocket.links": (
        "linked_to.inputs[0].links",
        "node_tree.links.remove(linked_to.inputs[0].links[0])",
        -1,
    ),
    "Mesh.vertices": ("other.data.vertices", _LOST, -1),
    "Mesh.edges": ("other.data.edges", _LOST, -2),
    "Mesh.polygons": ("other.data.polygons", _LOST, -1),
    "Mesh.loops": ("other.data.loops", _LOST, -3),
}
_RUN = """
import json, os, sys
import bpy

def in_edit_mode():
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")

def new_bone():
    in_edit_mode()
    bone = armature.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")

def remove_bone():
    in_edit_mode()
    armature.edit_bones.remove(armature.edit_bones["Root"])
    bpy.ops.object.mode_set(mode="OBJECT")

def remove_slots():
    ob.data.materials.append(material)
    ob.data.materials.pop(index=0)
    assert [slot.material for slot in ob.material_slots] == [material]
    ob.data.materials.pop(index=0)
    assert [slot.material for slot in ob.material_slots] == [None]
    ob.data.materials.clear()

def tracked(folder):
    image = bpy.data.images.new("i", 8, 8)
    image.filepath_raw, image.file_format = folder + "/i.png", "PNG"
    image.save()
    made = bpy.data.movieclips.load(image.filepath_raw)
    for number in range(4):
        track = made.tracking.tracks.new(name="t", frame=1)
        track.markers[0].co = 0.2 + 0.6 * (number % 2), 0.2 + 0.6 * (number // 2)
        track.select = True
    return made

def in_clip_editor(operator):
    area = bpy.context.window.screen.areas[0]
    area.type = "CLIP_EDITOR"
    area.spaces.active.clip = clip
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(area=area, region=region):
        operator()

counts = []
for collection, change in json.load(open(sys.argv[-1])):
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    ob = bpy.data.objects["Cube"]
    mesh = ob.data
    ob.shape_key_add(name="Basis")
    ob.shape_key_add(name="Top")
    material = bpy.data.materials.new("m")
    def linked(name, data):
        made = bpy.data.objects.new(name, data)
        bpy.context.collection.objects.link(made)
        return made
    def triangle():
        made = bpy.data.meshes.new("t")
        made.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        return made
    other, dusty, weighted = (linked(name, triangle()) for name in ("Other", "Dusty", "Weighted"))
    dusty.parent = weighted
    psys = dusty.modifiers.new("Dust", "PARTICLE_SYSTEM").particle_system
    psys.settings.physics_type = "BOIDS"
    bpy.context.view_layer.objects.active = ob
    ob.modifiers.new("Canvas", "DYNAMIC_PAINT")
    bpy.ops.dpaint.type_toggle(type="CANVAS")
    canvas = ob.modifiers["Canvas"].canvas_settings
    variable = ob.driver_add("location", 0).driver.variables.new()
    clip = tracked(os.path.dirname(sys.argv[-1]))
    weighted.vertex_groups.new(name="Group").add([0], 1.0, "REPLACE")
    new = bpy.data.objects.new("New", None)
    node_tree = bpy.data.node_groups.new("n", "ShaderNodeTree")
    valued, mixed, linked_to = (node_tree.nodes.new(f"ShaderNode{kind}") for kind in ("Value", "Math", "Math"))
    node_tree.links.new(valued.outputs[0], linked_to.inputs[0])
    text = bpy.data.texts.new("t")
    bpy.data.pointclouds.new("p")
    bpy.data.hair_curves.new("h")
    drawing = bpy.data.grease_pencils.new("g").layers.new("l").frames.new(1).drawing
    armature = bpy.data.armatures.new("a")
    rig = linked("Rig", armature)
    in_edit_mode()
    bone = armature.edit_bones.new("Root")
    bone.tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    for one in scene.objects:
        one.select_set(one == ob)
    own = [name for name in ("new", "add", "append", "link", "remove") if hasattr(eval(collection), name)]
    before = len(eval(collection))
    exec(change)
    bpy.context.view_layer.update()
    counts.append((own, len(eval(collection)) - before))
open(sys.argv[-1], "w").write(json.dumps(counts))
"""


def _tried(folder: Path, table: dict[str, tuple[str, str, int]]) -> list[tuple[list[str], int]]:
    """For each collection which functions it has, and by how many elements it grows."""
    asked = [(collection, change) for collection, change, _ in table.values()]
    return [(own, grown) for own, grown in told_by_blender(_RUN, folder, asked)]


@pytest.mark.parametrize(
    ("table", "lacking"),
    [
        pytest.param(_ADDED, {"new", "add", "append", "link"}, id="adds"),
        pytest.param(_REMOVED, {"remove"}, id="removes"),
    ],
)
def test_each_changes_a_collection_that_cannot(
    tmp_path: Path, table: dict[str, tuple[str, str, int]], lacking: set[str]
) -> None:
    done = zip(table.items(), _tried(tmp_path, table), strict=True)
    wrong = [
        (name, own, grown)
        for (name, (_, _, change)), (own, grown) in done
        if lacking.intersection(own) or grown != change
    ]
    assert wrong == []


def test_all_are_tried_and_known(kb: KnowledgeBase) -> None:
    for told, tried in ((ADDED_BY, _ADDED), (REMOVED_BY, _REMOVED)):
        assert {path.removeprefix("bpy.types.") for path in told} == set(tried)
        assert all(kb.symbol(path) and kb.symbol(other.path) for path, other in told.items())


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("obj.material_slots.new()", "bpy.types.IDMaterials.append"),
        ("obj.data.shape_keys.key_blocks.remove(kb)", "bpy.types.Object.shape_key_remove"),
        ('armature.bones.new("Bone")', "bpy.types.ArmatureEditBones.new"),
        ('bpy.data.pointclouds.new("P").points.add(3)', "bpy.types.PointCloud.resize"),
        ('bpy.data.hair_curves.new("H").curves.add(3)', "bpy.types.Curves.add_curves"),
        ("context.view_layer.objects.selected.add(ob)", "bpy.types.Object.select_set"),
        ("var = drv.variables.new()\nt = var.targets.new()", "bpy.types.DriverVariable.type"),
        ("AttributeError: 'ParticleSystems' object has no attribute 'new'", "bpy.types.ObjectModifiers.new"),
    ],
)
def test_answers_say_where_it_is_done(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    told = [*ADDED_BY.values(), *REMOVED_BY.values()]
    assert any(other.how in answer.notes for other in told if other.path == first)


@pytest.mark.parametrize(
    ("query", "first", "said"),
    [
        ('obj.data.shape_keys["Smile"].value = 1', "bpy.types.ShapeKey.value", '`.key_blocks["Smile"]`'),
        ('rig.pose["Bone"].location', "bpy.types.PoseBone.location", '`.bones["Bone"]`'),
        (
            'material.node_tree["Mix"].inputs[0].default_value',
            'bpy.types.ShaderNodeMix.inputs["Factor"]',
            '`.nodes["Mix"]`',
        ),
    ],
)
def test_elements_are_looked_up_in_the_collection(
    kb: KnowledgeBase, query: str, first: str, said: str
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    assert said in answer.notes[0]


def test_custom_properties_stay_what_they_are(kb: KnowledgeBase) -> None:
    notes = kb.query('pose.bones["Arm"]["ik_fk"] = 1.0').notes
    assert '`["ik_fk"]` is a custom property of `bpy.types.PoseBone`' in notes[0]
