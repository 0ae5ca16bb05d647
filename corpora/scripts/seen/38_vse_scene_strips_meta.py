"""VSE: put two scenes into the sequencer as strips, wrap them in a meta strip and add speed control."""
import bpy


def make_scene(name, color):
    sc = bpy.data.scenes.new(name)
    sc.frame_start, sc.frame_end = 1, 50
    cam = bpy.data.objects.new(name + "Cam", bpy.data.cameras.new(name + "Cam"))
    cam.location = (0, -8, 2)
    cam.rotation_euler = (1.4, 0, 0)
    sc.collection.objects.link(cam)
    sc.camera = cam
    me = bpy.data.meshes.new(name + "Mesh")
    me.from_pydata([(-1, 0, 0), (1, 0, 0), (0, 0, 2)], [], [(0, 1, 2)])
    tri = bpy.data.objects.new(name + "Tri", me)
    tri.color = color
    sc.collection.objects.link(tri)
    return sc


edit = bpy.context.scene
edit.name = "Edit"
ed = edit.sequence_editor_create()

a = make_scene("ShotA", (1, 0, 0, 1))
b = make_scene("ShotB", (0, 0, 1, 1))

meta = ed.sequences.new_meta(name="Shots", channel=2, frame_start=1)
start = 1
for sc in (a, b):
    strip = meta.sequences.new_scene(name=sc.name, scene=sc, channel=1, frame_start=start)
    strip.scene_input = 'CAMERA'
    strip.frame_offset_end = 5
    start = strip.frame_final_end

shots = ed.sequences.new_scene("Extra", a, 4, 120)
shots.frame_final_duration = 30
shots.mute = False
shots.use_flip_x = True
shots.strobe = 2

speed = ed.sequences.new_effect(name="Slow", type='SPEED', channel=5, frame_start=120,
                                frame_end=150, seq1=shots)
speed.speed_control = 'MULTIPLY'
speed.speed_factor = 0.5

blur = ed.sequences.new_effect("Soft", 'GAUSSIAN_BLUR', 6, frame_start=120, frame_end=150, seq1=speed)
blur.size_x = 8
blur.size_y = 8

edit.timeline_markers.new("Cut", frame=46)
edit.frame_end = 150
ed.active_strip = meta
meta.update()
print("top level:", [s.name for s in ed.sequences])
print("in meta:", [(s.name, s.frame_start, s.frame_final_duration) for s in meta.sequences])
for s in ed.sequences_all:
    s.select = s.type == 'SCENE'
