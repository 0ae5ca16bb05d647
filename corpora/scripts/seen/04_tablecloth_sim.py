"""Simulate a tablecloth falling over a round table with cloth physics."""
import bpy
from mathutils import Vector

scene = bpy.context.scene
scene.frame_start = 1
scene.frame_end = 80

for ob in list(bpy.data.objects):
    if ob.type == 'MESH':
        bpy.data.objects.remove(ob, do_unlink=True)

bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=1.2, depth=0.1, location=(0, 0, 1))
table = bpy.context.object
table.name = "Table"
col = table.modifiers.new("Collision", 'COLLISION')
table.collision.thickness_outer = 0.02
table.collision.cloth_friction = 15.0
table.collision.damping = 0.5

bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=4, location=(0, 0, 1.3))
cloth_ob = bpy.context.object
cloth_ob.name = "Tablecloth"

cloth = cloth_ob.modifiers.new("Cloth", 'CLOTH')
s = cloth.settings
s.quality = 8
s.mass = 0.3
s.air_damping = 1.0
s.bending_model = 'ANGULAR'
s.tension_stiffness = 15
s.compression_stiffness = 15
s.shear_stiffness = 5
s.bending_stiffness = 0.5

c = cloth.collision_settings
c.use_collision = True
c.collision_quality = 4
c.distance_min = 0.015
c.use_self_collision = True
c.self_distance_min = 0.015

cloth.point_cache.frame_start = 1
cloth.point_cache.frame_end = 80

subsurf = cloth_ob.modifiers.new("Subdivision", 'SUBSURF')
subsurf.levels = 1
for poly in cloth_ob.data.polygons:
    poly.use_smooth = True

override = {'scene': scene, 'active_object': cloth_ob, 'point_cache': cloth.point_cache}
with bpy.context.temp_override(**override):
    bpy.ops.ptcache.bake(bake=True)

scene.frame_set(80)
depsgraph = bpy.context.evaluated_depsgraph_get()
ev = cloth_ob.evaluated_get(depsgraph)
zs = [(ev.matrix_world @ Vector(v.co)).z for v in ev.data.vertices]
print("Cloth z range:", min(zs), max(zs))
