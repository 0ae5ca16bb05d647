"""Make two actions (wave and spin), push them to NLA tracks and blend them."""
import bpy
import math

scene = bpy.context.scene
bpy.ops.mesh.primitive_cube_add(size=1)
ob = bpy.context.object
ob.name = "NLAObject"
ob.animation_data_create()


def make_action(name, path, index, samples):
    act = bpy.data.actions.new(name)
    act.id_root = 'OBJECT'
    fc = act.fcurves.new(data_path=path, index=index, action_group="Transforms")
    fc.keyframe_points.add(len(samples))
    for kp, (f, v) in zip(fc.keyframe_points, samples):
        kp.co = (f, v)
        kp.interpolation = 'BEZIER'
    fc.update()
    act.use_fake_user = True
    return act


wave = make_action("Wave", "location", 2, [(1 + i * 5, math.sin(i * 0.5 * math.pi)) for i in range(9)])
spin = make_action("Spin", "rotation_euler", 2, [(1, 0), (41, 2 * math.pi)])

ad = ob.animation_data
ad.action = None

track = ad.nla_tracks.new()
track.name = "Base"
s1 = track.strips.new("Wave", 1, wave)
s1.repeat = 3
s1.blend_type = 'REPLACE'
s1.extrapolation = 'HOLD_FORWARD'

track2 = ad.nla_tracks.new(prev=track)
track2.name = "Layer"
s2 = track2.strips.new("Spin", 20, spin)
s2.blend_type = 'COMBINE'
s2.use_auto_blend = False
s2.blend_in = 10
s2.blend_out = 10
s2.scale = 1.5
s2.use_animated_influence = True
s2.influence = 0.0
s2.keyframe_insert("influence", frame=20)
s2.influence = 1.0
s2.keyframe_insert("influence", frame=40)

scene.frame_end = int(max(s1.frame_end, s2.frame_end))
for f in (1, 30, 60):
    scene.frame_set(f)
    print(f, ob.matrix_world.to_translation().z, ob.matrix_world.to_euler().z)
