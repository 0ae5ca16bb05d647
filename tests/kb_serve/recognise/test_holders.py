"""What holds a thing does what the thing is asked to do: the told calls do so, in this environment's Blender."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.recognise.elsewhere.holders import by_what_holds_it

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

T = "bpy.types."
# (class, name that it lacks) → an instance, what the told call is written behind, what its arguments are, and what is
# counted before and after.
DONE = {
    ("Object", "delete"): ("ob", "", "object = ob", "bpy.data.objects", -1),
    ("Object", "unlink"): ("ob", "coll", "object = ob", "coll.objects", -1),
    ("Mesh", "remove"): ("mesh", "", "", "bpy.data.meshes", -1),
    ("SubsurfModifier", "remove"): ("ob.modifiers[0]", "ob", "modifier = ob.modifiers[0]", "ob.modifiers", -1),
    ("Constraint", "delete"): ("ob.constraints[0]", "ob", "constraint = ob.constraints[0]", "ob.constraints", -1),
    ("ShaderNode", "remove"): ("tree.nodes[0]", "tree", "node = tree.nodes[0]", "tree.nodes", -1),
    ("NodeLink", "destroy"): ("tree.links[0]", "tree", "link = tree.links[0]", "tree.links", -1),
    ("TimelineMarker", "delete"): (
        "scene.timeline_markers[0]", "scene", "marker = scene.timeline_markers[0]", "scene.timeline_markers", -1,
    ),
    ("VertexGroup", "delete"): ("ob.vertex_groups[0]", "ob", "group = ob.vertex_groups[0]", "ob.vertex_groups", -1),
    ("Keyframe", "remove"): (
        "curve.keyframe_points[0]", "curve", "keyframe = curve.keyframe_points[0]", "curve.keyframe_points", -1,
    ),
    ("Collection", "append"): ("coll", "coll", "object = new", "coll.objects", 1),
    ("Collection", "remove"): ("coll", "coll", "object = ob", "coll.objects", -1),
    ("Scene", "add"): ("scene", "scene", "object = new", "scene.collection.objects", 1),
    ("Mesh", "add_material"): ("mesh", "mesh", "material = mat", "mesh.materials", 1),
    ("Mesh", "add_vertex"): ("mesh", "mesh", "count = 1", "mesh.vertices", 1),
    ("Object", "addModifier"): ("ob", "ob", "name, type = 'a', 'BEVEL'", "ob.modifiers", 1),
    ("Object", "remove_constraint"): ("ob", "ob", "constraint = ob.constraints[0]", "ob.constraints", -1),
    ("NodeTree", "add"): ("tree", "tree", "type = 'ShaderNodeMix'", "tree.nodes", 1),
    ("Material", "add_node"): ("mat", "mat", "type = 'ShaderNodeMix'", "tree.nodes", 1),
    ("FCurve", "add_keyframe"): ("curve", "curve", "frame, value = 50, 1", "curve.keyframe_points", 1),
    ("BlendData", "add_material"): ("bpy.data", "", "name = 'b'", "bpy.data.materials", 1),
    ("NodeTree", "link"): ("tree", "tree", "input, output = ends", "tree.links", 1),
    ("NodeTreeInterfaceSocket", "remove"): (
        "group.interface.items_tree[0]", "group.interface", "item = group.interface.items_tree[0]",
        "group.interface.items_tree", -1,
    ),
    ("BoneCollection", "append"): ("fk", "fk", "bone = rig.bones[0]", "fk.bones", 1),
    ("BoneCollection", "discard"): ("full", "full", "bone = rig.bones[0]", "full.bones", -1),
    ("SequenceEditor", "add_meta"): (
        "sequencer", "sequencer", "name, channel, frame_start = 'm', 1, 1", "sequencer.strips", 1,
    ),
    ("bmesh.types.BMesh", "add_vertex"): ("bm", "bm", "", "bm.verts", 1),
    ("bmesh.types.BMVert", "delete"): ("bm.verts[0]", "bm", "vert = bm.verts[0]", "bm.verts", -1),
    ("Mesh", "new"): ("mesh", "", "", "bpy.data.meshes", 1),
}  # fmt: skip
_RUN = """
import json, sys
import bpy
import bmesh
told = []
for thing, name, given, statement, counted in json.load(open(sys.argv[-1])):
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    ob = bpy.data.objects["Cube"]
    coll, mesh = ob.users_collection[0], ob.data
    mat = bpy.data.materials.new("m")
    mat.use_nodes = True
    tree = mat.node_tree
    ob.modifiers.new("s", "SUBSURF")
    ob.constraints.new("COPY_LOCATION")
    ob.vertex_groups.new(name="g")
    ob.keyframe_insert("location", index=0)
    curve = ob.animation_data.action.layers[0].strips[0].channelbags[0].fcurves[0]
    scene.timeline_markers.new("t")
    new = bpy.data.objects.new("n", None)
    ends = tree.nodes.new("ShaderNodeMath").inputs[0], tree.nodes.new("ShaderNodeValue").outputs[0]
    group = bpy.data.node_groups.new("g", "ShaderNodeTree")
    group.interface.new_socket("s")
    rig = bpy.data.armatures.new("r")
    held = bpy.data.objects.new("h", rig)
    coll.objects.link(held)
    bpy.context.view_layer.objects.active = held
    bpy.ops.object.mode_set(mode="EDIT")
    rig.edit_bones.new("b").tail = 0, 0, 1
    bpy.ops.object.mode_set(mode="OBJECT")
    fk, full = rig.collections.new("f"), rig.collections.new("g")
    full.assign(rig.bones[0])
    sequencer = scene.sequence_editor_create()
    bm = bmesh.new()
    bm.from_mesh(mesh)
    bm.verts.ensure_lookup_table()
    has = hasattr(eval(thing), name)
    before = len(eval(counted))
    exec(given)
    exec(statement)
    told.append((has, len(eval(counted)) - before))
open(sys.argv[-1], "w").write(json.dumps(told))
"""


def _call(how: str) -> str:
    found = re.search(r"`(?:bpy\.data)?(\.[^`]+\))`|`(bpy\.data\.[^`]+\))`", how)
    assert found is not None, how
    return found[2] or how.partition(found[1])[0].rpartition("`")[2] + found[1]


def test_the_told_calls_do_it_in_blender(reader: BaseReader, tmp_path: Path) -> None:
    asked: list[tuple[str, str, str, str, str]] = []
    for (owner, name), (thing, before, given, counted, _) in DONE.items():
        first = by_what_holds_it(owner if "." in owner else T + owner, name, reader)[0]
        assert first.path in first.how
        asked.append((thing, name, given, before + _call(first.how), counted))
    told = told_by_blender(_RUN, tmp_path, asked)
    assert dict(zip(DONE, told, strict=True)) == {key: [False, row[-1]] for key, row in DONE.items()}


@pytest.mark.parametrize(
    "path",
    [
        "Object.add",  # too much that could be meant
        "Object.add_shape_key",  # shape_key_add
        "Object.duplicate",
        "Mesh.clear",
        "Panel.remove",
        "Context.add_object",
        "Nonsense.remove",
    ],
)
def test_nothing_is_said_where_nothing_holds_it(reader: BaseReader, path: str) -> None:
    owner, _, name = path.partition(".")
    assert by_what_holds_it(T + owner, name, reader) == []


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("obj.remove()", "BlendDataObjects.remove"),
        ("mod.delete()", "ObjectModifiers.remove"),
        ("bpy.data.collections['A'].remove(obj)", "CollectionObjects.unlink"),
        ("collection.append(obj)", "CollectionObjects.link"),
        ("bpy.context.scene.add_object(obj)", "CollectionObjects.link"),
        ("bpy.types.Node.remove", "Nodes.remove"),
        ("AttributeError: 'EditBone' object has no attribute 'delete'", "ArmatureEditBones.remove"),
        ("obj.vertex_groups.add('g')", "VertexGroups.new"),
    ],
)
def test_a_query_is_answered_with_it(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == T + first
    notes = "\n".join(answer.notes)
    assert "has no" in notes
    assert "temp_override" not in notes


def test_a_kind_that_has_it_itself_is_read_as_such(kb: KnowledgeBase) -> None:
    assert kb.query("cryptomatte.remove").hits[0].id.startswith(f"{T}CompositorNodeCryptomatte")
    assert kb.query("vertex_group.remove([0])").hits[0].id == f"{T}VertexGroup.remove"
    assert kb.query("menu.append(draw)").hits[0].id == f"{T}Menu.append"
