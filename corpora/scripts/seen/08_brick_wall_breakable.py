"""Brick wall glued together with breakable fixed rigid body constraints."""
import bpy
from mathutils import Vector

ROWS, COLS = 6, 8
W, H, D = 0.5, 0.25, 0.25

scene = bpy.context.scene
if not scene.rigidbody_world:
    bpy.ops.rigidbody.world_add()

rb_coll = bpy.data.collections.new("RigidBodies")
con_coll = bpy.data.collections.new("RigidBodyConstraintsColl")
scene.rigidbody_world.collection = rb_coll
scene.rigidbody_world.constraints = con_coll

wall = bpy.data.collections.new("Wall")
scene.collection.children.link(wall)

verts = [(x * W / 2, y * D / 2, z * H / 2) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
mesh = bpy.data.meshes.new("Brick")
mesh.from_pydata(verts, [], faces)
mesh.update()

bricks = {}
for r in range(ROWS):
    for c in range(COLS):
        ob = bpy.data.objects.new(f"Brick_{r}_{c}", mesh)
        ob.location = ((c + 0.5 * (r % 2)) * W, 0, H / 2 + r * H)
        wall.objects.link(ob)
        rb_coll.objects.link(ob)
        ob.rigid_body.mass = 2.0
        ob.rigid_body.collision_shape = 'BOX'
        ob.rigid_body.use_deactivation = True
        ob.rigid_body.use_start_deactivated = True
        bricks[r, c] = ob


def glue(a, b):
    e = bpy.data.objects.new("Glue", None)
    e.location = (a.location + b.location) / 2
    e.empty_display_size = 0.05
    wall.objects.link(e)
    con_coll.objects.link(e)
    rc = e.rigid_body_constraint
    rc.type = 'FIXED'
    rc.object1, rc.object2 = a, b
    rc.use_breaking = True
    rc.breaking_threshold = 8.0


for (r, c), ob in bricks.items():
    if (r, c + 1) in bricks:
        glue(ob, bricks[r, c + 1])
    if (r + 1, c) in bricks:
        glue(ob, bricks[r + 1, c])

bpy.ops.mesh.primitive_plane_add(size=20)
bpy.ops.rigidbody.object_add(type='PASSIVE')
print(len(bricks), "bricks,", len(con_coll.objects), "constraints")
