"""Make UVs from Python: a planar projection layer, a cylinder projection layer, and mark seams."""
import bpy
import math

bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=1, depth=2)
ob = bpy.context.object
me = ob.data

uv_planar = me.uv_layers.new(name="Planar")
for loop in me.loops:
    co = me.vertices[loop.vertex_index].co
    uv_planar.data[loop.index].uv = (co.x * 0.5 + 0.5, co.y * 0.5 + 0.5)

uv_cyl = me.uv_layers.new(name="Cylindrical")
for poly in me.polygons:
    angles = []
    for li in poly.loop_indices:
        co = me.vertices[me.loops[li].vertex_index].co
        angles.append((math.atan2(co.y, co.x) / (2 * math.pi)) % 1.0)
    wrap = max(angles) - min(angles) > 0.5
    for li, a in zip(poly.loop_indices, angles):
        co = me.vertices[me.loops[li].vertex_index].co
        if wrap and a < 0.5:
            a += 1.0
        uv_cyl.data[li].uv = (a, co.z * 0.5 + 0.5)

me.uv_layers.active = uv_cyl
uv_cyl.active_render = True

for e in me.edges:
    a, b = (me.vertices[i].co for i in e.vertices)
    same_ring = abs(a.z - b.z) < 1e-5
    e.use_seam = same_ring or (a.x > 0.99 and b.x > 0.99)

bpy.context.view_layer.objects.active = ob
bpy.ops.object.mode_set(mode='EDIT')
bpy.ops.mesh.select_all(action='SELECT')
me.uv_layers.new(name="Unwrapped")
me.uv_layers.active_index = len(me.uv_layers) - 1
bpy.ops.uv.unwrap(method='ANGLE_BASED', margin=0.02)
bpy.ops.uv.average_islands_scale()
bpy.ops.uv.pack_islands(margin=0.01, rotate=True)
bpy.ops.object.mode_set(mode='OBJECT')

uvs = [0.0] * (len(me.loops) * 2)
me.uv_layers["Unwrapped"].data.foreach_get("uv", uvs)
print("u range", min(uvs[0::2]), max(uvs[0::2]))
print("layers", [l.name for l in me.uv_layers])
