"""Emit particles like a fountain, render small spheres and let them bounce on the floor."""
import bpy
import random


def main():
    scene = bpy.context.scene
    scene.frame_end = 200

    bpy.ops.mesh.primitive_plane_add(size=12)
    floor = bpy.context.object
    floor.modifiers.new("Collision", 'COLLISION')
    floor.collision.damping_factor = 0.4
    floor.collision.friction_factor = 0.1
    floor.collision.damping_random = 0.2

    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.05, location=(0, 0, -10))
    drop = bpy.context.object
    drop.name = "Drop"
    m = bpy.data.materials.new("DropMat")
    m.diffuse_color = (0.1, 0.4, 1, 1)
    drop.data.materials.append(m)

    bpy.ops.mesh.primitive_circle_add(vertices=16, radius=0.1, fill_type='NGON', location=(0, 0, 0.3))
    emitter = bpy.context.object
    emitter.name = "Fountain"
    emitter.show_instancer_for_render = False
    bpy.ops.object.particle_system_add()
    ps = emitter.particle_systems.active
    ps.name = "Spray"
    ps.seed = random.randint(0, 1000)
    p = ps.settings
    p.count = 1500
    p.frame_start = 1
    p.frame_end = 150
    p.lifetime = 80
    p.lifetime_random = 0.3
    p.emit_from = 'FACE'
    p.normal_factor = 6.0
    p.factor_random = 0.8
    p.physics_type = 'NEWTON'
    p.mass = 0.1
    p.drag_factor = 0.02
    p.use_size_deflect = True
    p.particle_size = 0.6
    p.size_random = 0.5
    p.render_type = 'OBJECT'
    p.instance_object = drop
    p.effector_weights.gravity = 1.0

    bpy.ops.object.effector_add(type='TURBULENCE', location=(0, 0, 2))
    turb = bpy.context.object
    turb.field.strength = 3
    turb.field.size = 0.8

    for f in range(1, 60):
        scene.frame_set(f)
    dg = bpy.context.evaluated_depsgraph_get()
    ev = emitter.evaluated_get(dg)
    alive = [q for q in ev.particle_systems[0].particles if q.alive_state == 'ALIVE']
    print("alive:", len(alive))
    if alive:
        print("highest:", max(q.location.z for q in alive))


main()
