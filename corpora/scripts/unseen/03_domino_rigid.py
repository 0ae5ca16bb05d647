"""Build a row of 30 dominoes along a curve and let a ball knock them over with rigid body physics."""
import bpy
import math

scene = bpy.context.scene

for ob in list(scene.objects):
    bpy.data.objects.remove(ob, do_unlink=True)

if scene.rigidbody_world is None:
    bpy.ops.rigidbody.world_add()
rbw = scene.rigidbody_world
rbw.steps_per_second = 240
rbw.solver_iterations = 20
rbw.point_cache.frame_end = 200

bpy.ops.mesh.primitive_plane_add(size=30)
floor = bpy.context.object
floor.name = "Floor"
bpy.ops.rigidbody.object_add()
floor.rigid_body.type = 'PASSIVE'
floor.rigid_body.friction = 0.8

radius = 5
count = 30
for i in range(count):
    a = math.pi * i / count
    x = math.cos(a) * radius
    y = math.sin(a) * radius
    bpy.ops.mesh.primitive_cube_add(size=1, location=(x, y, 0.5), rotation=(0, 0, a + math.pi / 2))
    d = bpy.context.object
    d.name = "Domino_%02d" % i
    d.scale = (0.1, 0.5, 1.0)
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    bpy.ops.rigidbody.object_add(type='ACTIVE')
    d.rigid_body.mass = 0.3
    d.rigid_body.collision_shape = 'BOX'
    d.rigid_body.friction = 0.4
    d.rigid_body.use_margin = True
    d.rigid_body.collision_margin = 0.0

bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(radius, -2, 0.8))
ball = bpy.context.object
ball.name = "Ball"
bpy.ops.rigidbody.object_add(type='ACTIVE')
ball.rigid_body.collision_shape = 'SPHERE'
ball.rigid_body.mass = 2
ball.rigid_body.kinematic = True
ball.keyframe_insert("location", frame=1)
ball.location.y = -0.6
ball.keyframe_insert("location", frame=12)
for fc in ball.animation_data.action.fcurves:
    for kp in fc.keyframe_points:
        kp.interpolation = 'LINEAR'
ball.rigid_body.keyframe_insert("kinematic", frame=12)
ball.rigid_body.kinematic = False
ball.rigid_body.keyframe_insert("kinematic", frame=13)

bpy.ops.ptcache.bake_all(bake=True)
print("done,", count, "dominoes")
