"""Drop all the small objects on the terrain with ray cast and align them to the surface normal."""
import bpy
import random
from mathutils import Vector
from mathutils.bvhtree import BVHTree

random.seed(7)

bpy.ops.mesh.primitive_grid_add(x_subdivisions=64, y_subdivisions=64, size=20)
terrain = bpy.context.object
terrain.name = "Terrain"
tex = bpy.data.textures.new("TerrainTex", type='CLOUDS')
tex.noise_scale = 4
tex.noise_depth = 3
disp = terrain.modifiers.new("Displace", 'DISPLACE')
disp.texture = tex
disp.strength = 4
disp.mid_level = 0.5

props = []
for i in range(25):
    x, y = random.uniform(-9, 9), random.uniform(-9, 9)
    bpy.ops.mesh.primitive_cone_add(radius1=0.3, depth=1, location=(x, y, 20))
    ob = bpy.context.object
    ob.name = "Prop_%02d" % i
    for v in ob.data.vertices:
        v.co.z += 0.5
    props.append(ob)

depsgraph = bpy.context.evaluated_depsgraph_get()
bvh = BVHTree.FromObject(terrain, depsgraph)
inv = terrain.matrix_world.inverted()

hits = 0
for ob in props:
    origin = inv @ ob.matrix_world.translation
    loc, normal, index, dist = bvh.ray_cast(origin, Vector((0, 0, -1)))
    if loc is None:
        continue
    hits += 1
    ob.location = terrain.matrix_world * loc
    up = (terrain.matrix_world.to_3x3() @ normal).normalized()
    ob.rotation_mode = 'QUATERNION'
    ob.rotation_quaternion = Vector((0, 0, 1)).rotation_difference(up)

result, location, normal, index, obj, matrix = bpy.context.scene.ray_cast(
    bpy.context.view_layer.depsgraph, Vector((0, 0, 50)), Vector((0, 0, -1)))
print("hits", hits, "scene ray:", result, obj.name if obj else None)
