"""Camera rig: turntable around the origin with track-to, depth of field, and camera switching with markers."""
import bpy
import math

scene = bpy.context.scene
scene.frame_start = 1
scene.frame_end = 120

target = bpy.data.objects.new("CamTarget", None)
target.empty_display_size = 0.3
target.location = (0, 0, 1)
pivot = bpy.data.objects.new("CamPivot", None)
pivot.empty_display_type = 'CIRCLE'
pivot.empty_display_size = 7
for e in (target, pivot):
    scene.collection.objects.link(e)


def camera(name, loc, lens=50):
    cd = bpy.data.cameras.new(name)
    cd.lens = lens
    cd.sensor_width = 36
    cd.sensor_fit = 'HORIZONTAL'
    cd.clip_start = 0.05
    cd.clip_end = 500
    cd.dof.use_dof = True
    cd.dof.focus_object = target
    cd.dof.aperture_fstop = 2.0
    cd.dof.aperture_blades = 7
    cd.show_passepartout = True
    cd.passepartout_alpha = 0.9
    ob = bpy.data.objects.new(name, cd)
    ob.location = loc
    scene.collection.objects.link(ob)
    con = ob.constraints.new(type='TRACK_TO')
    con.target = target
    con.track_axis = 'TRACK_NEGATIVE_Z'
    con.up_axis = 'UP_Y'
    return ob


orbit = camera("OrbitCam", (7, 0, 3))
orbit.parent = pivot
close = camera("CloseCam", (1.5, -3, 1.5), lens=85)

pivot.rotation_euler.z = 0
pivot.keyframe_insert("rotation_euler", index=2, frame=1)
pivot.rotation_euler.z = math.radians(360)
pivot.keyframe_insert("rotation_euler", index=2, frame=121)
for fc in pivot.animation_data.action.fcurves:
    for kp in fc.keyframe_points:
        kp.interpolation = 'LINEAR'

close.data.keyframe_insert("lens", frame=60)
close.data.lens = 35
close.data.keyframe_insert("lens", frame=120)

scene.camera = orbit
m1 = scene.timeline_markers.new("orbit", frame=1)
m1.camera = orbit
m2 = scene.timeline_markers.new("close", frame=60)
m2.camera = close

for f in (1, 30, 60, 90):
    scene.frame_set(f)
    print(f, scene.camera.name, [round(c, 2) for c in scene.camera.matrix_world.translation])
print("fov:", math.degrees(orbit.data.angle))
