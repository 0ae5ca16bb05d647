"""Generate a gear mesh with bmesh, number of teeth as parameter, with bevel."""
import bpy
import bmesh
import math


def make_gear(name="Gear", teeth=16, r_base=1.0, r_tip=1.25, width=0.4, hole=0.3):
    bm = bmesh.new()
    outer = []
    inner = []
    steps = teeth * 4
    for i in range(steps):
        a = 2 * math.pi * i / steps
        r = r_tip if i % 4 in (1, 2) else r_base
        outer.append(bm.verts.new((math.cos(a) * r, math.sin(a) * r, 0)))
        inner.append(bm.verts.new((math.cos(a) * hole, math.sin(a) * hole, 0)))
    bm.verts.ensure_lookup_table()

    faces = []
    for i in range(steps):
        j = (i + 1) % steps
        faces.append(bm.faces.new((inner[i], outer[i], outer[j], inner[j])))

    ret = bmesh.ops.extrude_face_region(bm, geom=faces)
    verts = [e for e in ret["geom"] if isinstance(e, bmesh.types.BMVert)]
    bmesh.ops.translate(bm, vec=(0, 0, width), verts=verts)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)

    sharp = [e for e in bm.edges if len(e.link_faces) == 2 and e.calc_face_angle() > math.radians(60)]
    bmesh.ops.bevel(bm, geom=sharp, offset=0.015, segments=2, profile=0.5, affect='EDGES')

    bevel_layer = bm.edges.layers.bevel_weight.verify()
    crease = bm.edges.layers.crease.verify()
    for e in bm.edges:
        e[crease] = 0.0
        e[bevel_layer] = 0.0

    me = bpy.data.meshes.new(name)
    bm.to_mesh(me)
    bm.free()
    me.validate()
    me.update()
    return bpy.data.objects.new(name, me)


gear_a = make_gear(teeth=16)
gear_b = make_gear("GearSmall", teeth=8, r_base=0.45, r_tip=0.68, hole=0.15)
gear_b.location.x = 1.75
for g in (gear_a, gear_b):
    bpy.context.collection.objects.link(g)
    print(g.name, len(g.data.vertices), "verts", len(g.data.polygons), "faces")
