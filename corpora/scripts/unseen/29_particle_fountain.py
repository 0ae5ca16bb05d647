"""Particle fountain: emitter throws small spheres up, they fall and bounce on a collision floor."""
import bpy

scene = bpy.context.scene
scene.frame_end = 150

bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.1, location=(10, 0, 0))
drop = bpy.context.object
drop.name = "Drop"

bpy.ops.mesh.primitive_plane_add(size=15)
floor = bpy.context.object
floor.name = "Floor"
bpy.ops.object.modifier_add(type='COLLISION')
floor.collision.damping_factor = 0.4
floor.collision.friction_factor = 0.3
floor.collision.particle_kill = False if hasattr(floor.collision, "particle_kill") else None
floor.collision.permeability = 0.0

bpy.ops.mesh.primitive_circle_add(vertices=24, radius=0.3, fill_type='NGON', location=(0, 0, 0.2))
em = bpy.context.object
em.name = "Fountain"

mod = em.modifiers.new("Fountain", 'PARTICLE_SYSTEM')
ps = em.particle_systems[0]
s = ps.settings
s.count = 1000
s.frame_start = 1
s.frame_end = 100
s.lifetime = 80
s.lifetime_random = 0.3
s.normal_factor = 7
s.factor_random = 1.2
s.object_align_factor = (0, 0, 1)
s.physics_type = 'NEWTON'
s.particle_size = 0.5
s.size_random = 0.5
s.mass = 0.1
s.use_multiply_size_mass = True
s.use_rotations = True
s.rotation_factor_random = 1
s.angular_velocity_mode = 'RAND'
s.angular_velocity_factor = 2
s.render_type = 'OBJECT'
s.instance_object = drop
s.use_scale_instance = True
s.effector_weights.gravity = 1.0
s.effector_weights.wind = 0.2
em.show_instancer_for_render = False

ps.point_cache.frame_start = 1
ps.point_cache.frame_end = 150

for f in range(1, 51):
    scene.frame_set(f)
dg = bpy.context.evaluated_depsgraph_get()
ps_eval = em.evaluated_get(dg).particle_systems[0]
alive = [p for p in ps_eval.particles if p.alive_state == 'ALIVE']
print("alive at 50:", len(alive))
