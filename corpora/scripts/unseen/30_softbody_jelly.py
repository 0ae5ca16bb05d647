"""Jelly cube as a soft body falling on the floor, with translucent material."""
import bpy

scene = bpy.context.scene

bpy.ops.mesh.primitive_plane_add(size=10)
floor = bpy.context.object
floor.modifiers.new("Collision", 'COLLISION')
floor.collision.thickness_outer = 0.02
floor.collision.damping = 0.3

bpy.ops.mesh.primitive_cube_add(size=1.5, location=(0, 0, 3), rotation=(0.3, 0.2, 0))
jelly = bpy.context.object
jelly.name = "Jelly"
bpy.ops.object.mode_set(mode='EDIT')
bpy.ops.mesh.subdivide(number_cuts=6)
bpy.ops.object.mode_set(mode='OBJECT')

mod = jelly.modifiers.new("Softbody", 'SOFT_BODY')
sb = mod.settings
sb.friction = 0.5
sb.mass = 1.0
sb.use_goal = False
sb.use_edges = True
sb.pull = 0.7
sb.push = 0.7
sb.damping = 5
sb.bend = 0.5
sb.plastic = 0
sb.use_stiff_quads = True
sb.shear = 0.9
sb.use_self_collision = True
sb.ball_size = 0.3
sb.step_min = 10
sb.step_max = 100
mod.point_cache.frame_end = 100

jelly.modifiers.new("Smooth", 'SUBSURF').levels = 2

mat = bpy.data.materials.new("JellyMat")
mat.use_nodes = True
b = mat.node_tree.nodes["Principled BSDF"]
b.inputs["Base Color"].default_value = (0.9, 0.05, 0.1, 1)
b.inputs["Subsurface"].default_value = 0.3
b.inputs["Subsurface Radius"].default_value = (1.0, 0.3, 0.2)
b.inputs["Transmission"].default_value = 0.6
b.inputs["Roughness"].default_value = 0.1
b.inputs["IOR"].default_value = 1.35
mat.use_screen_refraction = True
mat.refraction_depth = 0.2
jelly.data.materials.append(mat)

scene.frame_start = 1
scene.frame_end = 100
for f in range(1, 41):
    scene.frame_set(f)
dg = bpy.context.evaluated_depsgraph_get()
me = jelly.evaluated_get(dg).to_mesh()
print("lowest point at 40:", min((jelly.matrix_world @ v.co).z for v in me.vertices))
jelly.evaluated_get(dg).to_mesh_clear()
