# SPDX-License-Identifier: GPL-3.0-or-later
"""Physics for objects: one function for each part that an object can have in a simulation.

Caches cover the whole clip. Masses are in kilograms, angles in radians.
"""

import bpy
from mathutils import Matrix, Vector

from .scene_setup import FPS, keys, last


def cloth(obj, *, pins="", mass=0.3, quality=6, self_collision=False, stiffness=15.0, distance=0.012):
    """Makes cloth of ``mass`` a point, held by the vertex group ``pins``, at ``distance`` from colliders."""
    modifier = obj.modifiers.new("Cloth", "CLOTH")
    settings, collisions = modifier.settings, modifier.collision_settings
    settings.quality, settings.mass = quality, mass
    settings.tension_stiffness = settings.compression_stiffness = settings.shear_stiffness = stiffness
    settings.vertex_group_mass = pins
    collisions.use_self_collision = self_collision
    collisions.distance_min = collisions.self_distance_min = distance
    modifier.point_cache.frame_end = last()
    return modifier


def collider(obj, *, thickness=0.01, inner=0.2, friction=20.0, damping=0.5):
    """Stops cloth, soft bodies and particles. ``thickness``: how far outside of the surface they are stopped.

    ``inner``: how deep a soft body may get and is still pushed back, through the face that it is behind. In an object
    that is thinner than twice that, it is pushed both ways, and falls through.
    """
    modifier = obj.modifiers.new("Collision", "COLLISION")
    obj.collision.thickness_outer, obj.collision.thickness_inner = thickness, inner
    obj.collision.cloth_friction = friction
    obj.collision.use_culling = False  # else cloth sinks through faces that are not level
    obj.collision.damping = obj.collision.damping_factor = damping
    return modifier


def soft(obj, *, goal="", mass=1.0, stiffness=0.7, bending=0.5, stretch=0.0, damping=5.0, collision=None):
    """Makes a soft body. Points in the vertex group ``goal``, if named, are held in place by their weight."""
    modifier = obj.modifiers.new("Softbody", "SOFT_BODY")
    settings = modifier.settings
    settings.mass = mass
    settings.use_goal, settings.vertex_group_goal, settings.goal_default = bool(goal), goal, 1.0
    settings.use_edges = settings.use_stiff_quads = True
    settings.pull = settings.push = stiffness
    settings.bend, settings.plastic, settings.damping = bending, int(100 * stretch), damping
    settings.collision_collection = collision
    modifier.point_cache.frame_end = last()
    return modifier


def hook(obj, name, group, at):
    """Makes an empty that moves, turns and scales the points of a vertex group."""
    handle = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(handle)
    handle.location, handle.empty_display_size = at, 0.1
    bpy.context.view_layer.update()
    modifier = obj.modifiers.new("Hook", "HOOK")
    modifier.object, modifier.vertex_group = handle, group
    modifier.matrix_inverse = handle.matrix_world.inverted() @ obj.matrix_world
    return handle


def body(
    obj, kind="ACTIVE", *, shape="CONVEX_HULL", mass=1.0, friction=0.6, bounce=0.0, moved=False, margin=0.0
):
    """Makes a rigid body, and the world with the first. ``moved``: by its keys instead of the simulation."""
    scene = bpy.context.scene
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
        world = bpy.context.scene.rigidbody_world
        world.point_cache.frame_end = last()
        world.substeps_per_frame = 20
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.object_add(type=kind)
    settings = obj.rigid_body
    settings.collision_shape, settings.mass = shape, mass
    settings.friction, settings.restitution, settings.kinematic = friction, bounce, moved
    settings.use_margin, settings.collision_margin = True, margin
    return settings


def joint(name, kind, first, second, at=(0, 0, 0), *, turn=(0, 0, 0), collide=False):
    """Makes a constraint between two bodies: an empty whose axes are those of the constraint."""
    obj = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(obj)
    obj.location, obj.rotation_euler, obj.empty_display_size = at, turn, 0.1
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.constraint_add(type=kind)
    constraint = obj.rigid_body_constraint
    constraint.object1, constraint.object2, constraint.disable_collisions = first, second, not collide
    return constraint


def limits(tie, **axes):
    """Limits a joint along or around its axes: ``lin_x=(0, 0)`` locks one, ``ang_z=(-1, 1)`` is in radians."""
    for axis, (low, high) in axes.items():
        setattr(tie, f"use_limit_{axis}", True)
        setattr(tie, f"limit_{axis}_lower", low)
        setattr(tie, f"limit_{axis}_upper", high)


def thrown(obj, velocity, spin=(0, 0, 0), *, until=4):
    """Throws a rigid body: keys move it at ``velocity`` (m/s) and ``spin`` (radians a second) until that frame.

    Keys begin at frame 2: Blender may take a body's start from frame 1 or from frame 2. A body that is released before
    frame 4 does not keep its speed and just falls.
    """
    time, start = (until - 2) / FPS, obj.rotation_euler.copy()
    turned = Matrix.Rotation(Vector(spin).length * time, 3, Vector(spin) if any(spin) else Vector((0, 0, 1)))
    end = (turned @ start.to_matrix()).to_euler(start.order, start)
    place = obj.location.copy()
    keys(obj, "location", {2: place, until: place + Vector(velocity) * time}, even=True)
    keys(obj, "rotation_euler", {2: start, until: end}, even=True)
    keys(obj, "rigid_body.kinematic", {1: True, until: False})


def particles(
    obj, name, count, *, first=1, until=None, lifetime=50, size=0.02, shown=None, source="FACE", speed=1.0
):
    """Particles that an object emits, shown as the object ``shown``, which is then hidden itself (else as halos that
    renders leave out)."""
    modifier = obj.modifiers.new(name, "PARTICLE_SYSTEM")
    system = modifier.particle_system
    settings = system.settings
    settings.name = name
    settings.count, settings.frame_start, settings.frame_end = count, first, until or last()
    settings.lifetime, settings.emit_from, settings.normal_factor = lifetime, source, speed
    settings.particle_size, settings.display_size = size, size
    if shown is not None:
        settings.render_type, settings.instance_object = "OBJECT", shown
        shown.hide_render = shown.hide_viewport = True
    system.point_cache.frame_end = last()
    return settings


def hair(obj, name, count, *, length=0.2, dynamic=True):
    """Hair on an object; it is simulated if ``dynamic``."""
    modifier = obj.modifiers.new(name, "PARTICLE_SYSTEM")
    system = modifier.particle_system
    settings = system.settings
    settings.name = name
    settings.type, settings.count, settings.hair_length = "HAIR", count, length
    system.use_hair_dynamics = dynamic
    system.point_cache.frame_end = last()
    return settings


def field(name, kind, strength, at=(0, 0, 0), *, turn=(0, 0, 0), noise=0.0, size=1.0):
    """Makes a force field: an empty; wind blows along its Z."""
    bpy.ops.object.effector_add(type=kind, location=at, rotation=turn)
    obj = bpy.context.object
    obj.name = name
    obj.field.strength, obj.field.noise, obj.field.size = strength, noise, size
    return obj


def domain(obj, kind="LIQUID", *, resolution=40, mesh=True, adaptive=False):
    """Makes a fluid domain. ``mesh``: a liquid is shown as its surface."""
    modifier = obj.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    settings = modifier.domain_settings
    settings.domain_type, settings.resolution_max = kind, resolution
    settings.cache_type, settings.cache_frame_start, settings.cache_frame_end = "ALL", 1, last()
    if kind == "LIQUID":
        settings.use_mesh, settings.mesh_scale = mesh, 1
    else:
        settings.use_adaptive_domain = adaptive
    return settings


def flow(obj, kind="LIQUID", *, behavior="INFLOW", speed=None):
    """Makes a source of fluid. ``behavior`` GEOMETRY: the fluid's shape at the start, which itself is not rendered.

    ``speed``: of the fluid that comes out, in m/s.
    """
    obj.hide_render = behavior == "GEOMETRY"
    modifier = obj.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "FLOW"
    settings = modifier.flow_settings
    settings.flow_type, settings.flow_behavior = kind, behavior
    if speed is not None:
        settings.use_initial_velocity, settings.velocity_coord = True, speed
    return settings


def effector(obj, kind="COLLISION", *, thickness=0.0, planar=False):
    """Makes an obstacle or a guide of a fluid. ``planar``: an open mesh."""
    modifier = obj.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "EFFECTOR"
    settings = modifier.effector_settings
    settings.effector_type, settings.surface_distance, settings.use_plane_init = kind, thickness, planar
    return settings
