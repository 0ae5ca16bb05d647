"""Make a NURBS roller coaster track with bevel profile, tilt, and a cart that follows the path."""
import bpy
import math
from mathutils import Vector

N = 24
cu = bpy.data.curves.new("Track", type='CURVE')
cu.dimensions = '3D'
cu.twist_mode = 'MINIMUM'
cu.use_path = True
cu.path_duration = 120
cu.resolution_u = 6

sp = cu.splines.new('NURBS')
sp.points.add(N - 1)
for i, p in enumerate(sp.points):
    a = 2 * math.pi * i / N
    r = 6 + 1.5 * math.sin(3 * a)
    p.co = (r * math.cos(a), r * math.sin(a), 2 + 1.5 * math.sin(2 * a), 1.0)
    p.tilt = 0.3 * math.sin(a)
    p.radius = 1.0
    p.weight = 1.0
sp.use_cyclic_u = True
sp.order_u = 4
sp.use_endpoint_u = False

profile = bpy.data.curves.new("Profile", 'CURVE')
profile.dimensions = '2D'
ps = profile.splines.new('POLY')
ps.points.add(3)
for p, (x, y) in zip(ps.points, ((-0.3, 0), (0.3, 0), (0.3, 0.1), (-0.3, 0.1))):
    p.co = (x, y, 0, 1)
ps.use_cyclic_u = True
profile_ob = bpy.data.objects.new("Profile", profile)
track = bpy.data.objects.new("Track", cu)
for o in (profile_ob, track):
    bpy.context.scene.collection.objects.link(o)
cu.bevel_mode = 'OBJECT'
cu.bevel_object = profile_ob
cu.use_fill_caps = True
cu.bevel_factor_end = 1.0
profile_ob.hide_render = True
profile_ob.hide_viewport = True

bpy.ops.mesh.primitive_cube_add(size=0.8)
cart = bpy.context.object
cart.name = "Cart"
fp = cart.constraints.new('FOLLOW_PATH')
fp.target = track
fp.use_curve_follow = True
fp.forward_axis = 'FORWARD_Y'
fp.up_axis = 'UP_Z'
fp.use_fixed_location = True
fp.offset_factor = 0.0
fp.keyframe_insert("offset_factor", frame=1)
fp.offset_factor = 1.0
fp.keyframe_insert("offset_factor", frame=120)
for fc in cart.animation_data.action.fcurves:
    fc.extrapolation = 'LINEAR'
    for k in fc.keyframe_points:
        k.interpolation = 'LINEAR'

for f in (1, 40, 80):
    bpy.context.scene.frame_set(f)
    print(f, [round(c, 2) for c in cart.matrix_world.translation])
print("length:", round(sp.calc_length(), 2))
