"""Waving flag: pin one edge with a vertex group and add a wind force field."""
import bpy
import math


def create_flag():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=26, size=2,
                                    location=(0, 0, 3), rotation=(math.radians(90), 0, 0))
    flag = bpy.context.active_object
    flag.name = "Flag"
    flag.scale = (1.5, 1.0, 1.0)
    bpy.ops.object.transform_apply(location=False, rotation=True, scale=True)

    vg = flag.vertex_groups.new(name="Pin")
    min_x = min(v.co.x for v in flag.data.vertices)
    pinned = [v.index for v in flag.data.vertices if abs(v.co.x - min_x) < 0.001]
    vg.add(pinned, 1.0, 'REPLACE')

    mod = flag.modifiers.new(name="Cloth", type='CLOTH')
    mod.settings.vertex_group_mass = "Pin"
    mod.settings.pin_stiffness = 1.0
    mod.settings.mass = 0.15
    mod.settings.time_scale = 1.0
    mod.settings.effector_weights.gravity = 0.7
    mod.collision_settings.use_self_collision = True
    return flag


def create_wind():
    bpy.ops.object.effector_add(type='WIND', location=(-3, 1, 3),
                                rotation=(0, math.radians(90), math.radians(-10)))
    wind = bpy.context.object
    wind.field.strength = 900
    wind.field.flow = 1.0
    wind.field.noise = 3.0
    wind.field.seed = 7
    wind.field.keyframe_insert("strength", frame=1)
    wind.field.strength = 1400
    wind.field.keyframe_insert("strength", frame=60)
    for fc in wind.animation_data.action.fcurves:
        for kp in fc.keyframe_points:
            kp.interpolation = 'SINE'
    return wind


def create_pole():
    bpy.ops.mesh.primitive_cylinder_add(radius=0.05, depth=5, location=(-1.55, 0, 2))
    pole = bpy.context.object
    pole.name = "Pole"
    return pole


flag = create_flag()
create_pole()
create_wind()

scene = bpy.context.scene
scene.frame_end = 120
for f in range(1, 31):
    scene.frame_set(f)
print("Simulated to frame", scene.frame_current)
