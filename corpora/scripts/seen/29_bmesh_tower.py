"""Model a simple skyscraper with bmesh: extrude, inset windows, bevel edges, assign two materials."""
import bpy
import bmesh
from mathutils import Vector, Matrix
import random

random.seed(5)
bm = bmesh.new()
bmesh.ops.create_cube(bm, size=2.0, matrix=Matrix.Translation((0, 0, 1)))

for step in range(5):
    bm.faces.ensure_lookup_table()
    top = max(bm.faces, key=lambda f: f.calc_center_median().z)
    res = bmesh.ops.extrude_face_region(bm, geom=[top])
    verts = [g for g in res["geom"] if isinstance(g, bmesh.types.BMVert)]
    bmesh.ops.translate(bm, verts=verts, vec=(0, 0, random.uniform(1.0, 2.0)))
    bmesh.ops.delete(bm, geom=[top], context='FACES')
    center = sum((v.co for v in verts), Vector()) / len(verts)
    bmesh.ops.scale(bm, verts=verts, vec=(0.85, 0.85, 1.0), space=Matrix.Translation(-center))

vertical = [e for e in bm.edges
            if abs((e.verts[0].co - e.verts[1].co).normalized().z) > 0.9]
bmesh.ops.subdivide_edges(bm, edges=vertical, cuts=4, use_grid_fill=True)
horizontal = [e for e in bm.edges if abs((e.verts[0].co - e.verts[1].co).normalized().z) < 0.1]
bmesh.ops.subdivide_edges(bm, edges=horizontal, cuts=3, use_grid_fill=True)

bm.normal_update()
sides = [f for f in bm.faces if abs(f.normal.z) < 0.5]
ret = bmesh.ops.inset_individual(bm, faces=sides, thickness=0.05, depth=-0.04)
for f in sides:
    f.material_index = 1

bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=0.0001)
bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
boundary = [e for e in bm.edges if e.is_manifold and e.calc_face_angle() > 1.3]
bmesh.ops.bevel(bm, geom=boundary[:40], offset=0.01, segments=2, profile=0.5, affect='EDGES')

mesh = bpy.data.meshes.new("Tower")
bm.to_mesh(mesh)
bm.free()

ob = bpy.data.objects.new("Tower", mesh)
bpy.context.collection.objects.link(ob)
for name, color in (("Concrete", (0.5, 0.5, 0.5, 1)), ("Window", (0.1, 0.2, 0.4, 1))):
    mat = bpy.data.materials.new(name)
    mat.diffuse_color = color
    mesh.materials.append(mat)
mesh.use_auto_smooth = True
mesh.auto_smooth_angle = 0.6
mesh.calc_normals()
print(len(mesh.vertices), "verts", len(mesh.polygons), "faces")
