"""Render a still from every camera in the scene to its own PNG."""
import bpy
import os
import tempfile
from mathutils import Vector

scene = bpy.context.scene
out_dir = os.path.join(tempfile.gettempdir(), "cam_renders")
os.makedirs(out_dir, exist_ok=True)

if not any(o.type == 'MESH' for o in scene.objects):
    bpy.ops.mesh.primitive_monkey_add()

target = Vector((0, 0, 0))
for i, loc in enumerate([(6, -6, 4), (-6, -6, 4), (0, -8, 1)]):
    data = bpy.data.cameras.new("Shot_%02d" % i)
    cam = bpy.data.objects.new("Shot_%02d" % i, data)
    cam.location = loc
    cam.rotation_euler = (target - cam.location).to_track_quat('-Z', 'Y').to_euler()
    scene.collection.objects.link(cam)

r = scene.render
r.engine = 'CYCLES'
scene.cycles.samples = 8
scene.cycles.use_adaptive_sampling = True
scene.cycles.max_bounces = 4
r.tile_x = 256
r.tile_y = 256
r.resolution_x = 320
r.resolution_y = 180
r.resolution_percentage = 100
r.image_settings.file_format = 'PNG'
r.image_settings.color_mode = 'RGBA'
r.image_settings.color_depth = '8'
r.image_settings.compression = 15
r.film_transparent = True
r.use_stamp = True
r.use_stamp_camera = True
r.stamp_font_size = 12

old_cam = scene.camera
old_path = r.filepath
for ob in [o for o in scene.objects if o.type == 'CAMERA']:
    scene.camera = ob
    r.filepath = os.path.join(out_dir, ob.name + ".png")
    bpy.ops.render.render(write_still=True)
    print("rendered", r.filepath, os.path.exists(r.filepath))

scene.camera = old_cam
r.filepath = old_path
