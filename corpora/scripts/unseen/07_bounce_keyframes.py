"""Animate a bouncing ball with keyframes, bounce easing and cyclic modifier on the F-curves."""
import bpy

scene = bpy.context.scene
scene.frame_start = 1
scene.frame_end = 120

bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.5, location=(0, 0, 0.5))
ball = bpy.context.active_object
ball.name = "BouncingBall"
bpy.ops.object.shade_smooth()

keys = [(1, 0.5), (12, 4.0), (24, 0.5)]
for frame, z in keys:
    ball.location.z = z
    ball.keyframe_insert(data_path="location", index=2, frame=frame)

# squash and stretch
for frame, s in [(1, 0.7), (4, 1.15), (12, 1.0), (21, 1.15), (24, 0.7)]:
    ball.scale = (1 / s ** 0.5, 1 / s ** 0.5, s)
    ball.keyframe_insert(data_path="scale", frame=frame)

action = ball.animation_data.action
action.name = "BounceAction"

for fcu in action.fcurves:
    if fcu.data_path == "location" and fcu.array_index == 2:
        for kp in fcu.keyframe_points:
            kp.interpolation = 'BEZIER'
            if kp.co.y < 1.0:
                kp.handle_left_type = 'VECTOR'
                kp.handle_right_type = 'VECTOR'
            else:
                kp.handle_left_type = 'AUTO_CLAMPED'
                kp.handle_right_type = 'AUTO_CLAMPED'
    mod = fcu.modifiers.new(type='CYCLES')
    mod.mode_before = 'REPEAT'
    mod.mode_after = 'REPEAT'
    fcu.update()

# drift along X
fcu = action.fcurves.new("location", index=0)
fcu.keyframe_points.add(2)
fcu.keyframe_points[0].co = (1, -5)
fcu.keyframe_points[1].co = (120, 5)
for kp in fcu.keyframe_points:
    kp.interpolation = 'LINEAR'
fcu.update()

scene.frame_set(60)
print("location at 60:", ball.location)
