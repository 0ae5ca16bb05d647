"""Bake constraint motion to keyframes with nla.bake and then remove redundant keys from the F-curves."""
import bpy
import math

scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, 60

bpy.ops.object.empty_add(location=(0, 0, 0))
driver_ob = bpy.context.object
driver_ob.name = "Mover"
for f in (1, 20, 40, 60):
    driver_ob.location = (f * 0.1, math.sin(f * 0.1) * 2, 0)
    driver_ob.keyframe_insert("location", frame=f)

bpy.ops.mesh.primitive_cube_add(size=1)
cube = bpy.context.object
cube.name = "Follower"
c = cube.constraints.new('COPY_LOCATION')
c.target = driver_ob
c.use_offset = True
lim = cube.constraints.new('LIMIT_LOCATION')
lim.use_max_y = True
lim.max_y = 1.5
lim.owner_space = 'WORLD'

bpy.ops.object.select_all(action='DESELECT')
cube.select_set(True)
bpy.context.view_layer.objects.active = cube
bpy.ops.nla.bake(frame_start=1, frame_end=60, step=1, only_selected=True,
                 visual_keying=True, clear_constraints=True, clear_parents=False,
                 use_current_action=True, bake_types={'OBJECT'})

action = cube.animation_data.action


def reduce_keys(fc, tol=0.001):
    removed = 0
    i = 1
    while i < len(fc.keyframe_points) - 1:
        a, b, n = (fc.keyframe_points[j].co for j in (i - 1, i, i + 1))
        t = (b.x - a.x) / (n.x - a.x)
        if abs(a.y + (n.y - a.y) * t - b.y) < tol:
            fc.keyframe_points.remove(fc.keyframe_points[i], fast=True)
            removed += 1
        else:
            i += 1
    fc.update()
    return removed


for fc in list(action.fcurves):
    n = reduce_keys(fc)
    ys = [k.co.y for k in fc.keyframe_points]
    if max(ys) - min(ys) < 1e-5:
        print("constant, remove", fc.data_path, fc.array_index)
        action.fcurves.remove(fc)
    else:
        print(fc.data_path, fc.array_index, "removed", n, "left", len(fc.keyframe_points))

for grp in action.groups:
    print(grp.name, len(grp.channels))
print("range", tuple(action.frame_range))
