"""Mesh from pydata (spiral stairs) with custom attributes, creases, sharp edges, material per step, then print a report."""
import bpy
import math

STEPS = 24
verts, faces = [], []
for i in range(STEPS):
    a0 = i * math.radians(15)
    a1 = a0 + math.radians(15)
    z = i * 0.2
    base = len(verts)
    for zz in (z, z + 0.05):
        verts += [
            (math.cos(a0) * 0.3, math.sin(a0) * 0.3, zz),
            (math.cos(a0) * 1.5, math.sin(a0) * 1.5, zz),
            (math.cos(a1) * 1.5, math.sin(a1) * 1.5, zz),
            (math.cos(a1) * 0.3, math.sin(a1) * 0.3, zz),
        ]
    b = base
    faces += [(b + 3, b + 2, b + 1, b), (b + 4, b + 5, b + 6, b + 7)]
    for k in range(4):
        k2 = (k + 1) % 4
        faces.append((b + k, b + k2, b + 4 + k2, b + 4 + k))

me = bpy.data.meshes.new("Stairs")
me.from_pydata(verts, [], faces)
me.validate(verbose=False)

for n, c in (("Wood", (0.4, 0.2, 0.1, 1)), ("DarkWood", (0.2, 0.1, 0.05, 1))):
    m = bpy.data.materials.new(n)
    m.diffuse_color = c
    me.materials.append(m)

step_attr = me.attributes.new(name="step", type='INT', domain='FACE')
height_attr = me.attributes.new(name="height", type='FLOAT', domain='POINT')
step_attr.data.foreach_set("value", [i // 6 for i in range(len(me.polygons))])
height_attr.data.foreach_set("value", [v.co.z for v in me.vertices])

for p in me.polygons:
    p.material_index = (p.index // 6) % 2

for e in me.edges:
    e.crease = 0.5
    e.use_edge_sharp = True
    e.bevel_weight = 1.0

me.calc_loop_triangles()
me.calc_normals_split()

ob = bpy.data.objects.new("Stairs", me)
bpy.context.collection.objects.link(ob)

area = sum(p.area for p in me.polygons)
print("verts %d edges %d faces %d tris %d" % (len(me.vertices), len(me.edges), len(me.polygons), len(me.loop_triangles)))
print("area %.3f" % area)
for a in me.attributes:
    print(a.name, a.domain, a.data_type)
