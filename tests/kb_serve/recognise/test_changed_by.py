"""What is said to change a property that cannot be assigned does change it, in this environment's Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.recognise.changed_by import CHANGED_BY, changed_by

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

# Property → (a statement that Blender refuses, statements that change it, what is true before and after them).
_TRIED = {
    "Paint.brush": (
        "paint().brush = None",
        "paint(); bpy.ops.brush.asset_activate(asset_library_type='ESSENTIALS', relative_asset_identifier="
        "'brushes/essentials_brushes-mesh_sculpt.blend/Brush/Draw Sharp')",
        "paint().brush.name == 'Draw Sharp'",
    ),
    "MeshLoop.normal": (
        "mesh.loops[0].normal = (1, 0, 0)",
        "mesh.normals_split_custom_set([(1, 0, 0)] * len(mesh.loops))",
        "mesh.loops[0].normal.x > 0.9",
    ),
    "MeshNormalValue.vector": (
        "mesh.corner_normals[0].vector = (1, 0, 0)",
        "mesh.normals_split_custom_set([(1, 0, 0)] * len(mesh.loops))",
        "mesh.corner_normals[0].vector.x > 0.9",
    ),
    "MeshVertex.normal": (
        "mesh.vertices[0].normal = (1, 0, 0)",
        "mesh.normals_split_custom_set_from_vertices([(1, 0, 0)] * len(mesh.vertices))",
        "mesh.loops[0].normal.x > 0.9",
    ),
    "GreasePencilFrame.frame_number": (
        "layer.frames[0].frame_number = 5",
        "layer.frames.move(1, 5); layer.frames.copy(5, 9)",
        "[frame.frame_number for frame in layer.frames] == [5, 9]",
    ),
    "_bpy_internal.grease_pencil.stroke.GreasePencilStroke.curve_type": (
        "drawn.strokes[0].curve_type = 'POLY'",
        "drawn.set_types(type='BEZIER', indices=[0])",
        "drawn.strokes[0].curve_type == 2",
    ),
    "AnimData.action": (
        "tweaked.action = action",
        "tweaked.use_tweak_mode = False; tweaked.action = action",
        "tweaked.action == action",
    ),
    "Object.mode": ("ob.mode = 'EDIT'", "bpy.ops.object.mode_set(mode='EDIT')", "ob.mode == 'EDIT'"),
    "Object.type": (
        "text.type = 'MESH'",
        "bpy.context.view_layer.objects.active = text; bpy.ops.object.convert(target='MESH')",
        "bpy.data.objects['Text'].type == 'MESH'",
    ),
    "Image.size": ("image.size = (4, 2)", "image.scale(4, 2)", "image.size[:] == (4, 2)"),
    "Modifier.type": (
        "ob.modifiers.new('w', 'WAVE').type = 'SUBSURF'",
        "ob.modifiers.clear(); ob.modifiers.new('s', 'SUBSURF')",
        "[one.type for one in ob.modifiers] == ['SUBSURF']",
    ),
    "Mesh.shape_keys": (
        "mesh.shape_keys = None",
        "ob.shape_key_add(name='Key')",
        "mesh.shape_keys is not None",
    ),
    "Context.mode": (
        "bpy.context.mode = 'EDIT_MESH'",
        "bpy.ops.object.mode_set(mode='EDIT')",
        "bpy.context.mode == 'EDIT_MESH'",
    ),
    "Context.scene": (
        "bpy.context.scene = other",
        "bpy.context.window.scene = other",
        "bpy.context.scene == other",
    ),
    "Context.view_layer": (
        "bpy.context.view_layer = scene.view_layers[0]",
        "bpy.context.window.view_layer = scene.view_layers.new('Second')",
        "bpy.context.view_layer.name == 'Second'",
    ),
    "Context.object": (
        "bpy.context.object = camera",
        "bpy.context.view_layer.objects.active = camera",
        "bpy.context.object == camera",
    ),
    "Context.active_object": (
        "bpy.context.active_object = camera",
        "bpy.context.view_layer.objects.active = camera",
        "bpy.context.active_object == camera",
    ),
    "Context.selected_objects": (
        "bpy.context.selected_objects = [camera]",
        "camera.select_set(True)",
        "camera in bpy.context.selected_objects",
    ),
    "Scene.objects": (
        "scene.objects = [new]",
        "scene.collection.objects.link(new)",
        "new.name in scene.objects",
    ),
    **{
        f"Bone.{name}": (
            f"bone.{name} = None",
            f"edit(); armature.edit_bones['Bone'].{name.removesuffix('_local')} = {value}; end()",
            test,
        )
        for name, value, test in (
            ("head", "(0, 0, -1)", "near(bone.head, (0, 0, -1))"),
            ("tail", "(0, 0, 2)", "near(bone.tail, (0, 0, 2))"),
            ("head_local", "(0, 0, -1)", "near(bone.head_local, (0, 0, -1))"),
            ("tail_local", "(0, 0, 2)", "near(bone.tail_local, (0, 0, 2))"),
            ("matrix", "turned", "bone.vector.y < -0.9"),
            ("matrix_local", "turned", "bone.vector.y < -0.9"),
            ("length", "3", "abs(bone.length - 3) < 1e-4"),
            ("parent", "armature.edit_bones['Parent']", "bone.parent is not None"),
            ("use_connect", "True", "bone.use_connect"),
        )
    },
    **{
        f"PoseBone.{name}": (
            f"posed.{name} = (1, 0, 0)",
            "posed.location = (1, 0, 0); bpy.context.view_layer.update()",
            f"posed.{name}.x > 0.9",
        )
        for name in ("head", "tail")
    },
    **{
        f"Mesh.{name}": (
            f"mesh.{name} = []",
            "empty.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])",
            f"len(empty.{name}) > 0",
        )
        for name in ("vertices", "edges", "polygons")
    },
}
_RUN = """
import json, sys
import bpy
from mathutils import Matrix, Vector

def near(vector, other):
    return (vector - Vector(other)).length < 1e-4

def edit():
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")

def end():
    global bone
    bpy.ops.object.mode_set(mode="OBJECT")
    bone = armature.bones["Bone"]
    bpy.context.view_layer.objects.active = ob

def paint():
    if ob.mode != "SCULPT":
        bpy.ops.object.mode_set(mode="SCULPT")
    return bpy.context.tool_settings.sculpt

said = {}
for name, (refused, change, test) in json.load(open(sys.argv[-1])).items():
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    other = bpy.data.scenes.new("Other")
    ob = bpy.data.objects["Cube"]
    camera = bpy.data.objects["Camera"]
    mesh = ob.data
    new = bpy.data.objects.new("New", None)
    empty = bpy.data.meshes.new("Empty")
    text = bpy.data.objects.new("Text", bpy.data.curves.new("t", "FONT"))
    text.data.body = "A"
    scene.collection.objects.link(text)
    text.select_set(True)
    armature = bpy.data.armatures.new("Armature")
    rig = bpy.data.objects.new("Rig", armature)
    scene.collection.objects.link(rig)
    turned = Matrix.Rotation(3.14159265, 4, "X")
    edit()
    for one in ("Bone", "Parent"):
        armature.edit_bones.new(one).tail = (0, 1, 0)
    if name.endswith("use_connect"):
        armature.edit_bones["Bone"].parent = armature.edit_bones["Parent"]
    end()
    bone, posed = armature.bones["Bone"], rig.pose.bones["Bone"]
    image = bpy.data.images.new("i", 8, 8)
    action = bpy.data.actions.new("Other")
    tweaked = new.animation_data_create()
    tweaked.nla_tracks.new().strips.new("s", 1, bpy.data.actions.new("a"))
    tweaked.use_tweak_mode = True
    layer = bpy.data.grease_pencils.new("g").layers.new("l")
    drawn = layer.frames.new(1).drawing
    drawn.add_strokes([3])
    try:
        exec(refused)
        message = ""
    except AttributeError as error:
        message = f"AttributeError: {error}"
    before = eval(test)
    exec(change)
    said[name] = message, before, eval(test)
open(sys.argv[-1], "w").write(json.dumps(said))
"""


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, bool, bool]]:
    """Property → what Blender says to an assignment, and what is true before and after what changes it."""
    return told_by_blender(_RUN, tmp_path_factory.mktemp("changed"), _TRIED)


def test_each_is_refused_and_then_changed(
    kb: KnowledgeBase, tried: dict[str, tuple[str, bool, bool]]
) -> None:
    wrong = [name for name, (said, before, after) in tried.items() if not said or before or not after]
    assert wrong == []
    assert {path.removeprefix("bpy.types.") for path in CHANGED_BY} == set(tried)
    assert all(kb.symbol(path) and kb.symbol(changer) for path, (changer, _) in CHANGED_BY.items())


def test_the_message_leads_to_what_changes_it(
    kb: KnowledgeBase, tried: dict[str, tuple[str, bool, bool]]
) -> None:
    for said, _, _ in tried.values():
        answer = kb.query(said)
        changer, how = changed_by(answer.hits[0].id)
        assert changer
        assert how in answer.notes
        assert changer in [hit.id for hit in answer.hits[:3]]
