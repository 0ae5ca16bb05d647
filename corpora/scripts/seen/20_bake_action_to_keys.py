"""Copy an action to several objects with time offset, and bake the visual transform into keyframes."""
import bpy

scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, 60


def source_object():
    empty = bpy.data.objects.new("Leader", None)
    scene.collection.objects.link(empty)
    for f, loc in ((1, (0, 0, 0)), (30, (5, 2, 0)), (60, (0, 0, 3))):
        empty.location = loc
        empty.keyframe_insert("location", frame=f, group="Move")
    return empty


def offset_copy(src, target, offset):
    act = src.animation_data.action.copy()
    act.name = f"{target.name}_Action"
    for fc in act.fcurves:
        for kp in fc.keyframe_points:
            kp.co.x += offset
            kp.handle_left.x += offset
            kp.handle_right.x += offset
        fc.update()
    target.animation_data_create()
    target.animation_data.action = act


leader = source_object()
followers = []
for i in range(4):
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0, 0, 0))
    cube = bpy.context.object
    cube.name = f"Follower{i}"
    offset_copy(leader, cube, (i + 1) * 5)
    followers.append(cube)

bpy.ops.mesh.primitive_monkey_add(size=0.6)
suz = bpy.context.object
con = suz.constraints.new('COPY_LOCATION')
con.target = leader
track = suz.constraints.new('DAMPED_TRACK')
track.target = followers[0]
track.track_axis = 'TRACK_Y'

bpy.ops.object.select_all(action='DESELECT')
suz.select_set(True)
bpy.context.view_layer.objects.active = suz
bpy.ops.nla.bake(frame_start=1, frame_end=60, step=2, only_selected=True,
                 visual_keying=True, clear_constraints=True, use_current_action=True,
                 bake_types={'OBJECT'})

curves = suz.animation_data.action.fcurves
print("baked curves:", len(curves))
print("keys:", len(curves[0].keyframe_points))
