"""Hanging chain of links with rigid body point constraints, first link fixed and animated side to side."""
import bpy
import math

LINKS = 12
scene = bpy.context.scene
if not scene.rigidbody_world:
    bpy.ops.rigidbody.world_add()
scene.rigidbody_world.substeps_per_frame = 20
scene.rigidbody_world.solver_iterations = 30

if scene.rigidbody_world.constraints is None:
    scene.rigidbody_world.constraints = bpy.data.collections.new("RigidBodyConstraints")
if scene.rigidbody_world.collection is None:
    scene.rigidbody_world.collection = bpy.data.collections.new("RigidBodyWorld")

links = []
for i in range(LINKS):
    bpy.ops.mesh.primitive_torus_add(
        major_radius=0.3, minor_radius=0.07, major_segments=24, minor_segments=8,
        location=(0, 0, 6 - i * 0.45), rotation=(math.pi / 2, 0, (i % 2) * math.pi / 2))
    ob = bpy.context.active_object
    ob.name = "Link_%02d" % i
    ob.scale.y = 1.0
    bpy.ops.rigidbody.object_add()
    rb = ob.rigid_body
    rb.type = 'ACTIVE'
    rb.collision_shape = 'CONVEX_HULL'
    rb.mass = 0.5
    rb.linear_damping = 0.1
    rb.angular_damping = 0.3
    rb.collision_collections[0] = True
    links.append(ob)

links[0].rigid_body.kinematic = True

for a, b in zip(links, links[1:]):
    mid = (a.location + b.location) / 2
    bpy.ops.object.empty_add(type='PLAIN_AXES', radius=0.1, location=mid)
    e = bpy.context.object
    e.name = "Joint_" + a.name
    bpy.ops.rigidbody.constraint_add(type='POINT')
    c = e.rigid_body_constraint
    c.object1 = a
    c.object2 = b
    c.disable_collisions = True
    c.use_breaking = True
    c.breaking_threshold = 200

top = links[0]
for f in range(1, 202, 20):
    top.location.x = math.sin(f / 20.0 * math.pi / 2) * 1.5
    top.keyframe_insert("location", index=0, frame=f)

scene.frame_end = 200
for f in range(1, 60):
    scene.frame_set(f)
print("last link:", links[-1].matrix_world.translation)
