"""Animate a bouncing ball with keyframes, squash and stretch, and tweak the F-curve handles."""
import bpy

scene = bpy.context.scene
scene.frame_start = 1
scene.frame_end = 100
scene.render.fps = 24

bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(0, 0, 4))
ball = bpy.context.active_object
ball.name = "Ball"

frames = [1, 15, 29, 41, 53, 63, 73]
heights = [4.0, 0.5, 2.8, 0.5, 1.8, 0.5, 1.1]

for i, (f, z) in enumerate(zip(frames, heights)):
    ball.location = (i * 0.6, 0, z)
    ball.keyframe_insert(data_path="location", frame=f)
    if z == 0.5:
        ball.scale = (1, 1, 1)
        ball.keyframe_insert(data_path="scale", frame=f - 2)
        ball.keyframe_insert(data_path="scale", frame=f + 2)
        ball.scale = (1.25, 1.25, 0.65)
        ball.keyframe_insert(data_path="scale", frame=f)

action = ball.animation_data.action
action.name = "BallBounce"

for fcurve in action.fcurves:
    if fcurve.data_path == "location" and fcurve.array_index == 0:
        for kp in fcurve.keyframe_points:
            kp.interpolation = 'LINEAR'
    elif fcurve.data_path == "location" and fcurve.array_index == 2:
        for kp in fcurve.keyframe_points:
            kp.interpolation = 'BEZIER'
            if abs(kp.co[1] - 0.5) < 1e-4:
                kp.handle_left_type = 'VECTOR'
                kp.handle_right_type = 'VECTOR'
            else:
                kp.handle_left_type = 'AUTO_CLAMPED'
                kp.handle_right_type = 'AUTO_CLAMPED'
        fcurve.update()
    elif fcurve.data_path == "scale":
        fcurve.color_mode = 'AUTO_RGB'

z_curve = action.fcurves.find("location", index=2)
for f in (1, 8, 15, 22, 29):
    print(f, round(z_curve.evaluate(f), 3))
