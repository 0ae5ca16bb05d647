"""Make a flag that waves in the wind, pinned on the pole side, and bake the cloth."""
import bpy
from math import radians

scene = bpy.context.scene
scene.frame_start = 1
scene.frame_end = 80

bpy.ops.mesh.primitive_cylinder_add(radius=0.05, depth=5, location=(-1.5, 0, 0))
bpy.context.object.name = "Pole"

bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=26, size=2, location=(0, 0, 1.5))
flag = bpy.context.object
flag.name = "Flag"
flag.rotation_euler = (radians(90), 0, 0)
flag.scale = (1.5, 1.0, 1.0)
bpy.ops.object.transform_apply(location=False, rotation=True, scale=True)

vg = flag.vertex_groups.new(name="Pin")
min_x = min(v.co.x for v in flag.data.vertices)
pinned = [v.index for v in flag.data.vertices if abs(v.co.x - min_x) < 0.01]
vg.add(pinned, 1.0, 'REPLACE')

cloth = flag.modifiers.new("Cloth", 'CLOTH')
settings = cloth.settings
settings.quality = 7
settings.mass = 0.2
settings.tension_stiffness = 10
settings.compression_stiffness = 10
settings.shear_stiffness = 5
settings.bending_stiffness = 0.3
settings.air_damping = 1
settings.vertex_group_mass = "Pin"
settings.use_pin_cloth = True
cloth.collision_settings.use_self_collision = True
cloth.collision_settings.self_distance_min = 0.01
cloth.point_cache.frame_start = scene.frame_start
cloth.point_cache.frame_end = scene.frame_end

sub = flag.modifiers.new("Subsurf", 'SUBSURF')
sub.levels = 1
sub.render_levels = 2

bpy.ops.object.effector_add(type='WIND', location=(-4, -1, 1), rotation=(0, radians(90), 0))
wind = bpy.context.object
wind.field.strength = 600
wind.field.noise = 3
wind.field.flow = 0.5

bpy.ops.object.effector_add(type='TURBULENCE', location=(0, 0, 1))
turb = bpy.context.object
turb.field.strength = 40
turb.field.size = 1.2

bpy.context.view_layer.objects.active = flag
flag.select_set(True)
override = bpy.context.copy()
override['point_cache'] = cloth.point_cache
with bpy.context.temp_override(**override):
    bpy.ops.ptcache.bake(bake=True)
print("Cloth baked:", cloth.point_cache.is_baked)
