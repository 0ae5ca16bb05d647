"""What is used after it was removed is found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy, bmesh
bpy.ops.wm.read_factory_settings(use_empty=True)
me = bpy.data.meshes.new("m")
ob = bpy.data.objects.new("o", me)
bpy.context.collection.objects.link(ob)
modifier = ob.modifiers.new("s", "SUBSURF")
bm = bmesh.new()
vert = bm.verts.new((0, 0, 0))
depsgraph = bpy.context.evaluated_depsgraph_get()
"""
_GONE = "bpy.data.objects.remove(ob)\n"
_WRONG = {
    "read": f"{_GONE}ob.name",
    "set": f"{_GONE}ob.name = 'x'",
    "item": f"{_GONE}ob['x'] = 1",
    "in a text": f"{_GONE}print(f'{{ob.name}}')",
    "in a condition": f"{_GONE}if ob.parent:\n    pass",
    "given": f"{_GONE}bpy.context.collection.objects.link(ob)",
    "assigned": f"{_GONE}bpy.context.view_layer.objects.active = ob",
    "removed twice": f"{_GONE}{_GONE}",
    "in a function": f"def f(ob):\n    {_GONE}    return ob.name\nf(ob)",
    "in a loop": f"for ob in [ob]:\n    {_GONE}    print(ob.name)",
    "modifier": "ob.modifiers.remove(modifier)\nmodifier.levels",
    "by keyword": "bpy.data.meshes.remove(mesh=me, do_unlink=True)\nme.vertices",
    "mesh of an object": "own = ob.to_mesh()\nob.to_mesh_clear()\nown.vertices",
    "bmesh": "bm.free()\nbm.verts",
    "bmesh given": "bm.free()\nbmesh.ops.create_cube(bm)",
    "element": "bm.verts.remove(vert)\nvert.co",
    "element behind a layer": "layer = bm.verts.layers.float.new('x')\nvert[layer] = 1",
    "element of an item": "bm.verts.ensure_lookup_table()\nvert = bm.verts[0]\nbm.verts.layers.int.new('x')\nvert.co",
    "shape key": "key = ob.shape_key_add(name='k')\nob.shape_key_remove(key)\nkey.name",
    "list of instances": "kept = list(depsgraph.object_instances)\nkept[0].object",
    "comprehension": "kept = [i for i in depsgraph.object_instances]\nkept[0].matrix_world",
    "loop over a list": "for i in sorted(depsgraph.object_instances, key=str):\n    i.object",
}
_TWO = """\
bpy.ops.mesh.primitive_cube_add()
first = bpy.context.object
bpy.ops.mesh.primitive_uv_sphere_add()
second = bpy.context.object
"""
_BOTH = "first.select_set(True)\nbpy.context.view_layer.objects.active = first\n"
_JOIN = "bpy.ops.object.join()\n"
_EDIT = f"{_TWO}bpy.ops.object.mode_set(mode='EDIT')\nbm = bmesh.from_edit_mesh(second.data)\n"
_WRONG |= {
    "joined": f"{_TWO}{_BOTH}{_JOIN}second.name",
    "joined, selected anew": f"{_TWO}bpy.ops.object.select_all(action='DESELECT')\nsecond.select_set(True)\n{_BOTH}"
    f"second.location.x = 1\n{_JOIN}second.name",
    "joined, made by data": f"{_TWO}second = bpy.data.objects.new('m', first.data)\n"
    f"bpy.context.collection.objects.link(second)\nsecond.select_set(True)\n{_BOTH}{_JOIN}second.name",
    "joined, a copy": f"{_TWO}second = first.copy()\nbpy.context.collection.objects.link(second)\n"
    f"second.select_set(True)\n{_BOTH}{_JOIN}second.name",
    "edit mode left": f"{_EDIT}bpy.ops.object.mode_set(mode='OBJECT')\nbm.verts",
    "edit mode toggled": f"{_EDIT}bpy.ops.object.editmode_toggle()\nprint(bm.faces)",
    "edit mode entered again": f"{_EDIT}bpy.ops.object.mode_set(mode='OBJECT')\n"
    "bpy.ops.object.mode_set(mode='EDIT')\nbm.verts",
}
# What is read there is chance: the memory is free, and may hold what it held.
_OF_FREE_MEMORY = [
    "ob.modifiers.clear()\nmodifier.levels",
    "nodes = bpy.data.node_groups.new('t', 'ShaderNodeTree').nodes\nn = nodes.new('ShaderNodeMath')\n"
    "nodes.clear()\nn.operation",
    "layer = me.uv_layers.new(name='a')\nme.uv_layers.remove(layer)\nlayer.data",
]
_SOUND = {
    "layer of other elements": "bm.edges.layers.float.new('x')\nbm.loops.layers.uv.new('x')\nvert.co",
    "layer that is there": "bm.verts.layers.float.get('x')\nvert.co",
    "element behind its layer": "layer = bm.verts.layers.float.new('x')\nvert = bm.verts.new()\nvert[layer] = 1",
    "read before": f"name = ob.name\n{_GONE}print(name)",
    "bound again": f"{_GONE}ob = bpy.data.objects.new('o', None)\nob.name",
    "bound by a loop": f"{_GONE}for ob in bpy.data.objects:\n    ob.name",
    "another branch": f"if not ob.name:\n    {_GONE}else:\n    ob.name",
    "maybe": f"if not ob.name:\n    {_GONE}ob.name",
    "caught": f"{_GONE}try:\n    ob.name\nexcept ReferenceError:\n    pass",
    "only compared": f"{_GONE}print(ob, ob is None, [ob])",
    "another one": "other = bpy.data.objects.new('p', None)\nbpy.data.objects.remove(other)\nob.name",
    "by an own function": "def f():\n    global ob\n    ob = bpy.data.objects.new('o', None)\n"
    f"{_GONE}f()\nob.name",
    "list": "kept = ['a']\nkept.remove('a')\nkept.append('b')",
    "group of vertices": "group = ob.vertex_groups.new(name='g')\ngroup.remove([])\ngroup.name",
    "materials stay": "mat = bpy.data.materials.new('m')\nme.materials.append(mat)\nfirst = me.materials[0]\n"
    "me.materials.clear()\nfirst.name",
    "asked": "bm.free()\nprint(bm.is_valid)\nbm.free()",
    "another object's mesh": "twin = bpy.data.objects.new('p', me)\nown = ob.to_mesh()\ntwin.to_mesh()\n"
    "twin.to_mesh_clear()\nown.vertices",
    "other modifiers": "twin = bpy.data.objects.new('p', me)\ntwin.modifiers.clear()\nmodifier.levels",
    "instances in the loop": "for i in depsgraph.object_instances:\n    i.object.name",
    "counted": "kept = list(depsgraph.object_instances)\nprint(len(kept))",
    "values kept": "kept = [i.object.original for i in depsgraph.object_instances]\nkept[0].name",
    "numbered": "for n, i in enumerate(depsgraph.object_instances):\n    i.object",
}
_SOUND |= {
    "the active one stays": f"{_TWO}{_BOTH}{_JOIN}first.name",
    "not selected": f"{_TWO}second.select_set(False)\n{_BOTH}{_JOIN}second.name",
    "all deselected": f"{_TWO}bpy.ops.object.select_all(action='DESELECT')\n{_BOTH}{_JOIN}second.name",
    "deselected in a loop": f"{_TWO}for each in (second,):\n    each.select_set(False)\n{_BOTH}{_JOIN}second.name",
    "deselected by a function": f"def leave():\n    second.select_set(False)\n{_TWO}leave()\n{_BOTH}{_JOIN}second.name",
    "the active one is not selected": f"{_TWO}bpy.context.view_layer.objects.active = first\n{_JOIN}second.name",
    "of another type": f"{_TWO}bpy.ops.curve.primitive_bezier_circle_add()\nsecond = bpy.context.object\n"
    f"{_BOTH}{_JOIN}second.name",
    "the same one": f"{_TWO}second = first\nfirst.select_set(True)\n{_BOTH}{_JOIN}second.name",
    "the same one by its name": f"{_TWO}first.name = 'a'\nsecond = bpy.data.objects['a']\n"
    f"second.select_set(True)\n{_BOTH}{_JOIN}second.name",
    "data stay": f"{_TWO}data = second.data\n{_BOTH}{_JOIN}data.name",
    "edit mode stays": f"{_EDIT}bpy.ops.object.mode_set(mode='EDIT')\nbm.verts",
    "taken anew": f"{_EDIT}bpy.ops.object.mode_set(mode='OBJECT')\nbpy.ops.object.mode_set(mode='EDIT')\n"
    "bm = bmesh.from_edit_mesh(second.data)\nbm.verts",
    "asked whether it is valid": f"{_EDIT}bpy.ops.object.mode_set(mode='OBJECT')\nprint(bm.is_valid)",
    "another one leaves it": f"{_EDIT}bpy.context.view_layer.objects.active = ob\n"
    "bpy.ops.object.mode_set(mode='OBJECT')\nbm.verts",
    "left for a moment of its own": "new = bmesh.new()\n"
    f"{_EDIT}bpy.ops.object.mode_set(mode='OBJECT')\nnew.verts",
}


def test_what_is_removed_is_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "ReferenceError")
    found = {name: check("removed-data", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_reads_free_memory_is_found(check: Check) -> None:
    assert [code for code in _OF_FREE_MEMORY if not check("removed-data", f"{_START}{code}")] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("removed-data", f"{_START}{code}")] == []
