"""Mark seams by angle, unwrap several objects together, pack islands, and write a second lightmap UV map."""
import bpy
import bmesh
import math

obs = []
bpy.ops.mesh.primitive_cube_add(location=(0, 0, 0))
obs.append(bpy.context.object)
bpy.ops.mesh.primitive_cylinder_add(location=(3, 0, 0))
obs.append(bpy.context.object)
bpy.ops.mesh.primitive_torus_add(location=(-3, 0, 0))
obs.append(bpy.context.object)

for ob in obs:
    me = ob.data
    bm = bmesh.new()
    bm.from_mesh(me)
    for e in bm.edges:
        if len(e.link_faces) == 2:
            e.seam = e.calc_face_angle(0) > math.radians(60)
            e.smooth = not e.seam
    bm.to_mesh(me)
    bm.free()
    while len(me.uv_layers) > 0:
        me.uv_layers.remove(me.uv_layers[0])
    me.uv_layers.new(name="UVMap")
    me.uv_layers.new(name="Lightmap")
    me.uv_layers.active_index = 0
    me.uv_layers["UVMap"].active_render = True

bpy.ops.object.select_all(action='DESELECT')
for ob in obs:
    ob.select_set(True)
bpy.context.view_layer.objects.active = obs[0]

bpy.ops.object.mode_set(mode='EDIT')
bpy.ops.mesh.select_all(action='SELECT')
bpy.ops.uv.unwrap(method='ANGLE_BASED', margin=0.01)
bpy.ops.uv.select_all(action='SELECT')
bpy.ops.uv.average_islands_scale()
bpy.ops.uv.pack_islands(rotate=True, margin=0.01)
bpy.ops.object.mode_set(mode='OBJECT')

for ob in obs:
    ob.data.uv_layers.active = ob.data.uv_layers["Lightmap"]
bpy.ops.uv.lightmap_pack(PREF_CONTEXT='ALL_FACES', PREF_PACK_IN_ONE=True, PREF_NEW_UVLAYER=False, PREF_MARGIN_DIV=0.2)

for ob in obs:
    uv = ob.data.uv_layers["UVMap"].data
    us = [l.uv[0] for l in uv]
    sel = sum(1 for l in uv if l.select)
    print(ob.name, [l.name for l in ob.data.uv_layers], round(min(us), 3), round(max(us), 3), "selected", sel)
