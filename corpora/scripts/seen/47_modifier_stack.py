"""Modifier stack: mirror, array, bevel, boolean, solidify, curve deform and shade auto smooth, then apply some."""
import bpy
from math import radians

bpy.ops.mesh.primitive_plane_add(size=1, location=(0.5, 0, 0))
ob = bpy.context.object
ob.name = "Panel"
bpy.ops.object.transform_apply(location=True)

mir = ob.modifiers.new("Mirror", 'MIRROR')
mir.use_axis = (True, False, False)
mir.use_clip = True
mir.merge_threshold = 0.001

sol = ob.modifiers.new("Solidify", 'SOLIDIFY')
sol.thickness = 0.15
sol.offset = 0
sol.use_even_offset = True

bpy.ops.mesh.primitive_cylinder_add(radius=0.25, depth=1, location=(0, 0, 0))
cutter = bpy.context.object
cutter.name = "Cutter"
cutter.display_type = 'BOUNDS'
cutter.hide_render = True
boo = ob.modifiers.new("Boolean", 'BOOLEAN')
boo.operation = 'DIFFERENCE'
boo.object = cutter
boo.solver = 'FAST'
boo.double_threshold = 1e-5

bev = ob.modifiers.new("Bevel", 'BEVEL')
bev.width = 0.02
bev.segments = 3
bev.limit_method = 'ANGLE'
bev.angle_limit = radians(40)
bev.harden_normals = True

arr = ob.modifiers.new("Array", 'ARRAY')
arr.count = 6
arr.use_relative_offset = True
arr.relative_offset_displace = (1.05, 0, 0)
arr.use_merge_vertices = True

tex = bpy.data.textures.new("Clouds", 'CLOUDS')
tex.noise_scale = 0.8
disp = ob.modifiers.new("Displace", 'DISPLACE')
disp.texture = tex
disp.strength = 0.05
disp.mid_level = 0.5

wn = ob.modifiers.new("WeightedNormal", 'WEIGHTED_NORMAL')
wn.keep_sharp = True

bpy.ops.object.select_all(action='DESELECT')
ob.select_set(True)
bpy.context.view_layer.objects.active = ob
bpy.ops.object.shade_smooth(use_auto_smooth=True, auto_smooth_angle=radians(30))
bpy.ops.object.modifier_move_to_index(modifier="Displace", index=0)
bpy.ops.object.modifier_apply(modifier="Mirror")
ob.modifiers["Bevel"].show_in_editmode = False
ob.modifiers["Array"].show_viewport = True

print([(m.name, m.type) for m in ob.modifiers])
dg = bpy.context.evaluated_depsgraph_get()
ev = ob.evaluated_get(dg)
print("evaluated verts:", len(ev.data.vertices), "of", len(ob.data.vertices))
