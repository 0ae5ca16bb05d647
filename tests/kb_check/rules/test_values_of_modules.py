"""Values given to what is not RNA's: operators, elements and layers of bmesh, mathutils' trees, the context's override.

Each statement is run in Blender, which refuses the wrong ones only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_RULES = ["wrong-type", "missing-argument"]
_LINES = """\
import bpy, bmesh
from mathutils import Euler, Matrix, Quaternion, Vector, kdtree
from mathutils.bvhtree import BVHTree
from bpy_extras.object_utils import world_to_camera_view
bm = bmesh.new()
cube = bmesh.ops.create_cube(bm, size=2)
faces = [face for face in bm.faces if face.normal.z > 0.5]
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=faces)
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=bm.faces)
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=bm.verts)
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=cube["verts"])
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=bm.verts[:][0])
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=(bm.verts[:][0],))
bmesh.ops.translate(bm, vec=(0, 0, 1), verts={vert for vert in bm.verts})
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=(vert for vert in bm.verts))
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=tuple(vert for vert in bm.verts))
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=None)
bmesh.ops.translate(bm, vec=(0, 0), verts=bm.verts)
bmesh.ops.translate(bm, vec=1.0, verts=bm.verts)
bmesh.ops.translate(bm, vec=Quaternion(), verts=bm.verts)
bmesh.ops.translate(bm, vec=Euler(), verts=bm.verts)
bmesh.ops.rotate(bm, cent=(0, 0, 0), matrix=Matrix.Rotation(1, 3, "X"), verts=bm.verts)
bmesh.ops.rotate(bm, cent=(0, 0, 0), matrix=Quaternion(), verts=bm.verts)
bmesh.ops.rotate(bm, cent=(0, 0, 0), matrix=None, verts=bm.verts)
bmesh.ops.inset_region(bm, faces=bm.verts[:])
bmesh.ops.bevel(bm, geom=bm.edges[:] + bm.verts[:], offset=0.1, segments=1, affect="EDGES")
bmesh.ops.delete(bm, geom=set(bm.verts), context="VERTS")
bmesh.ops.bisect_plane(bm, geom=bm.verts[:] + bm.edges[:] + bm.faces[:], plane_co=(0, 0), plane_no=(0, 0, 1))
bmesh.ops.create_cube(bpy.data.meshes.new("x"))
grown = bmesh.ops.extrude_face_region(bm, geom=bm.faces[:])
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=[e for e in grown["geom"] if isinstance(e, bmesh.types.BMVert)])
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=grown["geom"])
bare = bmesh.ops.extrude_face_region(bm, geom=bm.verts[:1])
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=bare["geom"])
corners = [(0, 1, 2)]
made = [bm.faces.new(corner) for corner in corners]
made = [bm.faces.new([bm.verts.new((at, at * at, 9)) for at in corner]) for corner in corners]
vert, face = bm.verts[:][0], bm.faces[:][0]
loop = face.loops[0]
vert.co = (1, 1)
vert.co = 1.0
vert.co = (1, 1, 1)
vert.co = Vector((1, 1, 1))
face.select = 1.5
face.select = 1
face.material_index = 1.5
face.material_index = 1
uv = bm.loops.layers.uv.verify()
loop = bm.faces[:][0].loops[0]
loop[uv] = (0, 0)
loop[uv].uv = (0, 0)
loop[uv].uv = (0, 0, 0)
active = bm.loops.layers.uv.active
loop[active] = (0, 0)
loop[active].uv = (0, 0)
color = bm.loops.layers.color.new("color")
loop = bm.faces[:][0].loops[0]
loop[color] = 1.0
loop[color] = (1, 0, 0, 1)
weight = bm.verts.layers.float.new("weight")
vert = bm.verts[:][0]
vert[weight] = "a"
vert[weight] = None
vert[weight] = 1
number = bm.verts.layers.int.new("number")
vert = bm.verts[:][0]
vert[number] = 1.5
vert[number] = 1
text = bm.verts.layers.string.new("text")
vert = bm.verts[:][0]
vert[text] = "a"
vert[text] = b"a"
groups = bm.verts.layers.deform.verify()
vert = bm.verts[:][0]
vert[groups] = {0: 1.0}
vert[groups][0] = 1.0
tree = kdtree.KDTree()
tree = kdtree.KDTree(size=3)
tree.insert((0, 0, 0))
tree.insert((0, 0, 0), 0)
tree.balance()
near = tree.find_range((0, 0, 0))
near = tree.find_range((0, 0, 0), 1)
near = tree.find_n((0, 0, 0))
near = tree.find((0, 0, 0))
found = BVHTree.FromObject(bpy.data.objects["Cube"], bpy.context.scene)
found = BVHTree.FromObject(bpy.data.objects["Cube"], bpy.context.evaluated_depsgraph_get())
found = BVHTree.FromBMesh(bpy.data.meshes["Cube"])
found = BVHTree.FromBMesh(bm)
with bpy.context.temp_override(area=3): pass
with bpy.context.temp_override(area=None, scene=bpy.context.scene): pass
with bpy.context.temp_override(region=bpy.context.scene): pass
place = world_to_camera_view(bpy.context.scene, bpy.data.cameras["Camera"], Vector())
place = world_to_camera_view(bpy.context.scene, bpy.data.objects["Camera"], Vector())
"""


def test_what_is_found_is_what_blender_refuses(rule_checker: Checker, tmp_path: Path) -> None:
    lines: list[str] = [*_LINES.splitlines()]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_LINES, rules=_RULES)
    assert [one.span.line for one in found] == refused
    assert len(refused) == 39


def test_an_iterable_of_an_annotation_may_be_a_list(rule_checker: Checker) -> None:
    code = (
        "import bmesh\nfrom collections.abc import Iterable\n"
        "def lift(bm: bmesh.types.BMesh, verts: Iterable[bmesh.types.BMVert]) -> None:\n"
        "    bmesh.ops.translate(bm, vec=(0, 0, 1), verts=verts)\n"
    )
    assert rule_checker.check(code, rules=_RULES) == []
    assert len(rule_checker.check(code.replace("verts=verts", "verts=set(verts)"), rules=_RULES)) == 1


_PRIVATE: str = """\
import bpy
from bpy_extras.node_shader_utils import PrincipledBSDFWrapper
material = bpy.data.materials.new("x")
wrapper = PrincipledBSDFWrapper(material, is_readonly=False)
wrapper._grid_to_location(1, 2, ref_node=wrapper.node_principled_bsdf)
wrapper._textures
PrincipledBSDFWrapper._col_size
wrapper.grid_to_location
material._textures
bpy.types.Material._textures
wrapper.node_texcoords
wrapper.node_textures
"""


def test_private_names_of_modules_classes_are_unknown(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _PRIVATE.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert refused == [8, 9, 10, 12]
    found = rule_checker.check(_PRIVATE, rules=["unknown-attribute"])
    assert [finding.span.line for finding in found] == [8, 9, 10, 12]
