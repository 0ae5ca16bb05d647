"""Create an action by hand with F-curves, add noise and cycles modifiers, and push it to the NLA."""
import bpy
import math

ob = bpy.data.objects.get("Cube")
if ob is None:
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object

action = bpy.data.actions.new("Wobble")
action.use_fake_user = True
ob.animation_data_create()
ob.animation_data.action = action

fc_rot = action.fcurves.new(data_path="rotation_euler", index=2, action_group="Rotation")
fc_rot.keyframe_points.add(3)
for kp, (f, v) in zip(fc_rot.keyframe_points, [(1, 0), (24, math.radians(90)), (48, 0)]):
    kp.co = (f, v)
    kp.interpolation = 'BEZIER'
    kp.easing = 'AUTO'
fc_rot.update()
cyc = fc_rot.modifiers.new('CYCLES')
cyc.mode_before = 'REPEAT'
cyc.mode_after = 'REPEAT'

fc_loc = action.fcurves.new("location", index=2, action_group="Location")
fc_loc.keyframe_points.insert(1, 0.0)
fc_loc.keyframe_points.insert(100, 0.0)
noise = fc_loc.modifiers.new(type='NOISE')
noise.scale = 12
noise.strength = 1.5
noise.phase = 4.2
noise.blend_type = 'ADD'
noise.use_restricted_range = True
noise.frame_start = 1
noise.frame_end = 100
noise.blend_in = 10
noise.blend_out = 10

print("groups:", [g.name for g in action.groups])
print("range:", action.frame_range[:])

track = ob.animation_data.nla_tracks.new()
track.name = "WobbleTrack"
strip = track.strips.new("Wobble", int(action.frame_range[0]), action)
strip.repeat = 2.0
strip.blend_type = 'REPLACE'
strip.extrapolation = 'HOLD'
ob.animation_data.action = None

for f in (1, 24, 60, 120):
    bpy.context.scene.frame_set(f)
    print(f, ob.matrix_world.to_euler().z, ob.matrix_world.translation.z)
