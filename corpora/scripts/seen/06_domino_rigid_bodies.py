"""Row of dominoes that falls over with rigid body physics, starting from a pushed ball."""
import bpy
import math

scene = bpy.context.scene

if scene.rigidbody_world is None:
    bpy.ops.rigidbody.world_add()
rbw = scene.rigidbody_world
rbw.steps_per_second = 240
rbw.solver_iterations = 20
rbw.point_cache.frame_end = 200
scene.frame_end = 200

bpy.ops.mesh.primitive_plane_add(size=40, location=(0, 0, 0))
ground = bpy.context.object
ground.name = "Ground"
bpy.ops.rigidbody.object_add(type='PASSIVE')
ground.rigid_body.friction = 0.8

count = 24
spacing = 0.55
for i in range(count):
    angle = i * math.radians(4)
    x = i * spacing * math.cos(angle * 0.5)
    y = i * spacing * math.sin(angle * 0.5)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(x, y, 0.75), rotation=(0, 0, angle))
    d = bpy.context.object
    d.name = f"Domino.{i:03d}"
    d.scale = (0.12, 0.7, 1.5)
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    bpy.ops.rigidbody.object_add()
    rb = d.rigid_body
    rb.type = 'ACTIVE'
    rb.mass = 0.5
    rb.collision_shape = 'BOX'
    rb.friction = 0.4
    rb.restitution = 0.05
    rb.use_margin = True
    rb.collision_margin = 0.001

bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(-1.5, 0, 1.1))
ball = bpy.context.object
bpy.ops.rigidbody.object_add(type='ACTIVE')
ball.rigid_body.collision_shape = 'SPHERE'
ball.rigid_body.kinematic = True
ball.keyframe_insert("location", frame=1)
ball.location.x = -0.3
ball.keyframe_insert("location", frame=12)
ball.rigid_body.keyframe_insert("kinematic", frame=12)
ball.rigid_body.kinematic = False
ball.rigid_body.keyframe_insert("kinematic", frame=13)

bpy.ops.ptcache.free_bake_all()
bpy.ops.ptcache.bake_all(bake=True)
scene.frame_set(200)
last = bpy.data.objects[f"Domino.{count - 1:03d}"]
print(last.name, last.matrix_world.to_euler())
