"""Set up a turntable render of the scene: camera on an orbit empty, EEVEE, MP4 output."""
import bpy
import math
import os
import tempfile

FRAMES = 120
scene = bpy.context.scene

if not any(o.type == 'MESH' for o in scene.objects):
    bpy.ops.mesh.primitive_monkey_add()

pivot = bpy.data.objects.new("TurntablePivot", None)
pivot.empty_display_type = 'CIRCLE'
pivot.empty_display_size = 2
scene.collection.objects.link(pivot)

cam_data = bpy.data.cameras.new("TurntableCam")
cam_data.lens = 50
cam = bpy.data.objects.new("TurntableCam", cam_data)
scene.collection.objects.link(cam)
cam.location = (0, -8, 3)
cam.parent = pivot

track = cam.constraints.new('TRACK_TO')
track.target = pivot
track.track_axis = 'TRACK_NEGATIVE_Z'
track.up_axis = 'UP_Y'
scene.camera = cam

pivot.rotation_euler = (0, 0, 0)
pivot.keyframe_insert("rotation_euler", index=2, frame=1)
pivot.rotation_euler.z = 2 * math.pi
pivot.keyframe_insert("rotation_euler", index=2, frame=FRAMES + 1)
fc = pivot.animation_data.action.fcurves.find("rotation_euler", index=2)
for kp in fc.keyframe_points:
    kp.interpolation = 'LINEAR'

scene.frame_start = 1
scene.frame_end = FRAMES
r = scene.render
r.engine = 'BLENDER_EEVEE_NEXT'
scene.eevee.taa_render_samples = 32
scene.eevee.use_gtao = True
scene.eevee.use_bloom = False
r.resolution_x = 1280
r.resolution_y = 720
r.resolution_percentage = 50
r.fps = 30
r.film_transparent = False
r.image_settings.file_format = 'FFMPEG'
r.ffmpeg.format = 'MPEG4'
r.ffmpeg.codec = 'H264'
r.ffmpeg.constant_rate_factor = 'MEDIUM'
r.ffmpeg.ffmpeg_preset = 'GOOD'
r.filepath = os.path.join(tempfile.gettempdir(), "turntable.mp4")
print("ready: bpy.ops.render.render(animation=True) ->", r.filepath)
