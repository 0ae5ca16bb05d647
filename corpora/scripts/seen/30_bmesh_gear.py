"""Generate a gear with a hole in the middle with bmesh, parameters for teeth count and width."""
import bpy
import bmesh
from math import sin, cos, pi


def gear(teeth=16, r_inner=0.4, r_root=1.0, r_tip=1.2, width=0.3):
    bm = bmesh.new()
    steps = teeth * 4
    outer, inner = [], []
    for i in range(steps):
        a = 2 * pi * i / steps
        r = r_tip if (i % 4) in (1, 2) else r_root
        outer.append(bm.verts.new((r * cos(a), r * sin(a), 0)))
        inner.append(bm.verts.new((r_inner * cos(a), r_inner * sin(a), 0)))
    bm.verts.index_update()

    faces = []
    for i in range(steps):
        j = (i + 1) % steps
        faces.append(bm.faces.new((inner[i], outer[i], outer[j], inner[j])))

    geom = bmesh.ops.extrude_face_region(bm, geom=faces)
    top = [e for e in geom['geom'] if isinstance(e, bmesh.types.BMVert)]
    bmesh.ops.translate(bm, vec=(0, 0, width), verts=top)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])

    crease = bm.edges.layers.crease.verify()
    bevel = bm.edges.layers.bevel_weight.verify()
    for e in bm.edges:
        if len(e.link_faces) == 2 and e.calc_face_angle(0) > pi / 3:
            e[crease] = 0.8
            e[bevel] = 1.0
            e.smooth = False

    me = bpy.data.meshes.new(f"Gear{teeth}")
    bm.to_mesh(me)
    bm.free()
    return me


def place(mesh, loc, rot=0):
    ob = bpy.data.objects.new(mesh.name, mesh)
    ob.location = loc
    ob.rotation_euler[2] = rot
    bpy.context.scene.collection.objects.link(ob)
    bev = ob.modifiers.new("Bevel", 'BEVEL')
    bev.limit_method = 'WEIGHT'
    bev.width = 0.02
    bev.segments = 2
    return ob


a = place(gear(16), (0, 0, 0))
b = place(gear(16), (2.25, 0, 0), pi / 16)

for ob, sign in ((a, 1), (b, -1)):
    ob.keyframe_insert("rotation_euler", index=2, frame=1)
    ob.rotation_euler[2] += sign * 2 * pi
    ob.keyframe_insert("rotation_euler", index=2, frame=120)
    for kp in ob.animation_data.action.fcurves[0].keyframe_points:
        kp.interpolation = 'LINEAR'
print("volume-ish faces:", len(a.data.polygons))
