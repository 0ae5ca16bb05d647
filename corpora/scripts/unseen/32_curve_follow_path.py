"""Build a bezier roller coaster curve with bevel and make a cart follow it with a follow path constraint."""
import bpy
import math

scene = bpy.context.scene
scene.frame_end = 200

cu = bpy.data.curves.new("Track", 'CURVE')
cu.dimensions = '3D'
cu.resolution_u = 24
cu.bevel_depth = 0.05
cu.bevel_resolution = 2
cu.use_fill_caps = True
cu.twist_mode = 'MINIMUM'

sp = cu.splines.new('BEZIER')
n = 12
sp.bezier_points.add(n - 1)
for i, bp in enumerate(sp.bezier_points):
    a = 2 * math.pi * i / n
    bp.co = (math.cos(a) * 6, math.sin(a) * 4, 1.5 + math.sin(a * 3) * 1.2)
    bp.handle_left_type = 'AUTO'
    bp.handle_right_type = 'AUTO'
    bp.tilt = math.sin(a) * 0.4
    bp.radius = 1.0
sp.use_cyclic_u = True

track = bpy.data.objects.new("Track", cu)
scene.collection.objects.link(track)

bpy.ops.mesh.primitive_cube_add(size=0.6)
cart = bpy.context.object
cart.name = "Cart"
cart.scale = (0.6, 1, 0.5)

cu.use_path = True
cu.use_path_follow = True
cu.path_duration = 200

con = cart.constraints.new('FOLLOW_PATH')
con.target = track
con.use_curve_follow = True
con.use_fixed_location = True
con.forward_axis = 'FORWARD_Y'
con.up_axis = 'UP_Z'

con.offset_factor = 0.0
con.keyframe_insert("offset_factor", frame=1)
con.offset_factor = 1.0
con.keyframe_insert("offset_factor", frame=200)

fcu = cart.animation_data.action.fcurves.find('constraints["Follow Path"].offset_factor')
for kp in fcu.keyframe_points:
    kp.interpolation = 'LINEAR'

for f in (1, 50, 100):
    scene.frame_set(f)
    print(f, cart.matrix_world.translation)
