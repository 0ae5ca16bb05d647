"""Wrecking ball on a chain made of rigid body constraints (hinges and a point joint)."""
import bpy


def add_rb(obj, rb_type='ACTIVE', mass=1.0, shape='CONVEX_HULL'):
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.object_add(type=rb_type)
    obj.rigid_body.mass = mass
    obj.rigid_body.collision_shape = shape


def connect(a, b, location, kind='POINT'):
    empty = bpy.data.objects.new(f"{kind}_{a.name}_{b.name}", None)
    empty.empty_display_size = 0.15
    empty.empty_display_type = 'ARROWS'
    empty.location = location
    bpy.context.collection.objects.link(empty)
    bpy.context.view_layer.objects.active = empty
    bpy.ops.rigidbody.constraint_add(type=kind)
    con = empty.rigid_body_constraint
    con.object1 = a
    con.object2 = b
    con.disable_collisions = True
    return empty


bpy.ops.object.select_all(action='DESELECT')

bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0, 0, 6))
anchor = bpy.context.object
anchor.name = "Anchor"
add_rb(anchor, 'PASSIVE', shape='BOX')

prev = anchor
for i in range(8):
    x = 0.4 + i * 0.4
    bpy.ops.mesh.primitive_cylinder_add(radius=0.06, depth=0.36, location=(x, 0, 6),
                                        rotation=(0, 1.5708, 0))
    link = bpy.context.object
    link.name = f"Link{i}"
    add_rb(link, mass=0.2, shape='CAPSULE')
    connect(prev, link, (x - 0.2, 0, 6), 'POINT' if i else 'HINGE')
    prev = link

bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(4.2, 0, 6))
ball = bpy.context.object
ball.name = "WreckingBall"
add_rb(ball, mass=40, shape='SPHERE')
limit = connect(prev, ball, (3.6, 0, 6), 'GENERIC')
con = limit.rigid_body_constraint
for axis in "xyz":
    setattr(con, f"use_limit_lin_{axis}", True)
    setattr(con, f"limit_lin_{axis}_lower", 0.0)
    setattr(con, f"limit_lin_{axis}_upper", 0.0)

scene = bpy.context.scene
scene.rigidbody_world.substeps_per_frame = 20
scene.rigidbody_world.solver_iterations = 50
for f in range(1, 50):
    scene.frame_set(f)
print("Ball:", ball.matrix_world.translation)
