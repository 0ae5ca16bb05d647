"""Hard surface stack: array, mirror, boolean hole, bevel, weighted normal, then apply all modifiers."""
import bpy
import math

bpy.ops.mesh.primitive_cube_add(size=2, location=(1.5, 0, 0))
ob = bpy.context.object
ob.name = "Panel"

bpy.ops.mesh.primitive_cylinder_add(radius=0.5, depth=4, location=(1.5, 0, 0))
cutter = bpy.context.object
cutter.name = "Cutter"
cutter.display_type = 'WIRE'
cutter.hide_render = True

boolean = ob.modifiers.new("Hole", 'BOOLEAN')
boolean.operation = 'DIFFERENCE'
boolean.object = cutter
boolean.solver = 'FAST'

arr = ob.modifiers.new("Array", 'ARRAY')
arr.count = 3
arr.use_relative_offset = True
arr.relative_offset_displace = (0, 1.05, 0)
arr.use_merge_vertices = True

mir = ob.modifiers.new("Mirror", 'MIRROR')
mir.use_axis[0] = True
mir.use_bisect_axis[0] = False
mir.merge_threshold = 0.001

bev = ob.modifiers.new("Bevel", 'BEVEL')
bev.width = 0.03
bev.segments = 3
bev.limit_method = 'ANGLE'
bev.angle_limit = math.radians(30)
bev.harden_normals = True

wn = ob.modifiers.new("WeightedNormal", 'WEIGHTED_NORMAL')
wn.keep_sharp = True

ob.data.use_auto_smooth = True
for p in ob.data.polygons:
    p.use_smooth = True

bpy.ops.object.select_all(action='DESELECT')
ob.select_set(True)
bpy.context.view_layer.objects.active = ob
for mod in list(ob.modifiers):
    try:
        bpy.ops.object.modifier_apply(modifier=mod.name)
    except RuntimeError as e:
        print("could not apply", mod.name, e)

bpy.data.objects.remove(cutter)
print(ob.name, len(ob.data.vertices), "verts", len(ob.modifiers), "modifiers left")
