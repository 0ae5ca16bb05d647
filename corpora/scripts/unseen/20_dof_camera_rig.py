"""Camera with depth of field focused on an empty, dolly zoom animated over 100 frames."""
import bpy
import math

scene = bpy.context.scene
scene.frame_end = 100

subject = bpy.data.objects.get("Cube")
if subject is None:
    bpy.ops.mesh.primitive_cube_add()
    subject = bpy.context.object

focus = bpy.data.objects.new("FocusPoint", None)
focus.empty_display_type = 'SPHERE'
focus.empty_display_size = 0.3
focus.location = subject.location
bpy.context.collection.objects.link(focus)

cam_data = bpy.data.cameras.new("DollyCam")
cam = bpy.data.objects.new("DollyCam", cam_data)
bpy.context.collection.objects.link(cam)
scene.camera = cam

cam_data.sensor_width = 36
cam_data.dof.use_dof = True
cam_data.dof.focus_object = focus
cam_data.dof.aperture_fstop = 1.8
cam_data.dof.aperture_blades = 7
cam_data.show_passepartout = True
cam_data.passepartout_alpha = 0.9
cam_data.clip_end = 500

con = cam.constraints.new('DAMPED_TRACK')
con.target = focus
con.track_axis = 'TRACK_NEGATIVE_Z'

start_dist, end_dist = 14.0, 5.0
start_lens = 85.0
width = start_dist * cam_data.sensor_width / start_lens

for f in range(1, 101, 3):
    t = (f - 1) / 99.0
    t = t * t * (3 - 2 * t)
    d = start_dist + (end_dist - start_dist) * t
    cam.location = (0, -d, 1.5)
    cam_data.lens = d * cam_data.sensor_width / width
    cam.keyframe_insert(data_path="location", frame=f)
    cam_data.keyframe_insert(data_path="lens", frame=f)

for id_block in (cam, cam_data):
    for fc in id_block.animation_data.action.fcurves:
        fc.extrapolation = 'CONSTANT'
        for kp in fc.keyframe_points:
            kp.handle_left_type = kp.handle_right_type = 'AUTO'

scene.frame_set(50)
print("lens %.1f fov %.1f" % (cam_data.lens, math.degrees(cam_data.angle)))
