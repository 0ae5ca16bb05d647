# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes things move: one function for each part that a thing can play in a simulation, and the bake.

Caches cover the clip. Masses are kilograms, turns radians.
"""

import bpy
from mathutils import Matrix, Vector

from .stage import FPS, keys, last


def cloth(thing, *, pins="", mass=0.3, quality=6, self_collision=False, stiffness=15.0, distance=0.012):
    """Cloth of ``mass`` a point, held by the vertex group ``pins``; keeps ``distance`` from what it meets."""
    modifier = thing.modifiers.new("Cloth", "CLOTH")
    settings, collisions = modifier.settings, modifier.collision_settings
    settings.quality, settings.mass = quality, mass
    settings.tension_stiffness = settings.compression_stiffness = settings.shear_stiffness = stiffness
    settings.vertex_group_mass = pins
    collisions.use_self_collision = self_collision
    collisions.distance_min = collisions.self_distance_min = distance
    modifier.point_cache.frame_end = last()
    return modifier


def collider(thing, *, thickness=0.01, inner=0.2, friction=20.0, damping=0.5):
    """Stops cloth, soft bodies and particles. ``thickness``: how far outside of the surface they are stopped.

    ``inner``: how deep a soft body may get and is still pushed back, through the face that it is behind. In a thing
    that is thinner than twice that, it is pushed both ways, and falls through.
    """
    modifier = thing.modifiers.new("Collision", "COLLISION")
    thing.collision.thickness_outer, thing.collision.thickness_inner = thickness, inner
    thing.collision.cloth_friction = friction
    thing.collision.use_culling = False  # else cloth sinks through faces that are not level
    thing.collision.damping = thing.collision.damping_factor = damping
    return modifier


def soft(thing, *, goal="", mass=1.0, stiffness=0.7, bending=0.5, stretch=0.0, damping=5.0, collision=None):
    """A soft body. What is in the vertex group ``goal``, where one is named, is held fast by a weight of 1."""
    modifier = thing.modifiers.new("Softbody", "SOFT_BODY")
    settings = modifier.settings
    settings.mass = mass
    settings.use_goal, settings.vertex_group_goal, settings.goal_default = bool(goal), goal, 1.0
    settings.use_edges = settings.use_stiff_quads = True
    settings.pull = settings.push = stiffness
    settings.bend, settings.plastic, settings.damping = bending, int(100 * stretch), damping
    settings.collision_collection = collision
    modifier.point_cache.frame_end = last()
    return modifier


def hook(thing, name, group, at):
    """An empty that the points in a vertex group follow: they go, turn and stretch with it, from where they are."""
    handle = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(handle)
    handle.location, handle.empty_display_size = at, 0.1
    bpy.context.view_layer.update()
    modifier = thing.modifiers.new("Hook", "HOOK")
    modifier.object, modifier.vertex_group = handle, group
    modifier.matrix_inverse = handle.matrix_world.inverted() @ thing.matrix_world
    return handle


def body(
    thing, kind="ACTIVE", *, shape="CONVEX_HULL", mass=1.0, friction=0.6, bounce=0.0, moved=False, margin=0.0
):
    """A rigid body; the world comes with the first. ``moved``: by its keys rather than by the simulation."""
    scene = bpy.context.scene
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
        scene.rigidbody_world.point_cache.frame_end = last()
        scene.rigidbody_world.substeps_per_frame = 20
    bpy.context.view_layer.objects.active = thing
    bpy.ops.rigidbody.object_add(type=kind)
    settings = thing.rigid_body
    settings.collision_shape, settings.mass = shape, mass
    settings.friction, settings.restitution, settings.kinematic = friction, bounce, moved
    settings.use_margin, settings.collision_margin = True, margin
    return settings


def joint(name, kind, one, two, at=(0, 0, 0), *, turn=(0, 0, 0), collide=False):
    """A constraint of two bodies, as an empty whose axes it has."""
    thing = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(thing)
    thing.location, thing.rotation_euler, thing.empty_display_size = at, turn, 0.1
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = thing
    bpy.ops.rigidbody.constraint_add(type=kind)
    tie = thing.rigid_body_constraint
    tie.object1, tie.object2, tie.disable_collisions = one, two, not collide
    return tie


def limits(tie, **axes):
    """How far a joint gives along or around its axes: ``lin_x=(0, 0)`` not at all, ``ang_z=(-1, 1)`` in radians."""
    for axis, (low, high) in axes.items():
        setattr(tie, f"use_limit_{axis}", True)
        setattr(tie, f"limit_{axis}_lower", low)
        setattr(tie, f"limit_{axis}_upper", high)


def thrown(thing, velocity, spin=(0, 0, 0), *, until=4):
    """A hand moves a rigid body at ``velocity`` (m/s) and ``spin`` (radians a second) until that frame, and lets go.

    It begins at the second frame: where a body was at the first or at the second is where Blender makes it, as it
    happens. Let go before the fourth, it falls.
    """
    time, start = (until - 2) / FPS, thing.rotation_euler.copy()
    turned = Matrix.Rotation(Vector(spin).length * time, 3, Vector(spin) if any(spin) else Vector((0, 0, 1)))
    end = (turned @ start.to_matrix()).to_euler(start.order, start)
    place = thing.location.copy()
    keys(thing, "location", {2: place, until: place + Vector(velocity) * time}, even=True)
    keys(thing, "rotation_euler", {2: start, until: end}, even=True)
    keys(thing, "rigid_body.kinematic", {1: True, until: False})


def particles(
    thing, name, count, *, first=1, until=None, lifetime=50, size=0.02, shown=None, source="FACE", speed=1.0
):
    """Particles that a thing emits, shown as the object ``shown``, which is then hidden itself (else as halos that
    renders leave out)."""
    modifier = thing.modifiers.new(name, "PARTICLE_SYSTEM")
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


def hair(thing, name, count, *, length=0.2, dynamic=True):
    """Hair on a thing, which moves where ``dynamic``."""
    modifier = thing.modifiers.new(name, "PARTICLE_SYSTEM")
    system = modifier.particle_system
    settings = system.settings
    settings.name = name
    settings.type, settings.count, settings.hair_length = "HAIR", count, length
    system.use_hair_dynamics = dynamic
    system.point_cache.frame_end = last()
    return settings


def field(name, kind, strength, at=(0, 0, 0), *, turn=(0, 0, 0), noise=0.0, size=1.0):
    """A field of force, as an empty; wind blows along its Z."""
    bpy.ops.object.effector_add(type=kind, location=at, rotation=turn)
    thing = bpy.context.object
    thing.name = name
    thing.field.strength, thing.field.noise, thing.field.size = strength, noise, size
    return thing


def domain(thing, kind="LIQUID", *, resolution=40, mesh=True, adaptive=False):
    """The space in which a fluid is. A liquid is shown as its surface where ``mesh``."""
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    settings = modifier.domain_settings
    settings.domain_type, settings.resolution_max = kind, resolution
    settings.cache_type, settings.cache_frame_start, settings.cache_frame_end = "ALL", 1, last()
    if kind == "LIQUID":
        settings.use_mesh, settings.mesh_scale = mesh, 1
    else:
        settings.use_adaptive_domain = adaptive
    return settings


def flow(thing, kind="LIQUID", *, behavior="INFLOW", speed=None):
    """Where a fluid comes from, or (``behavior`` GEOMETRY) is at the start: then it is not rendered, as what is there
    is the fluid. ``speed``: of what comes out, m/s.
    """
    thing.hide_render = behavior == "GEOMETRY"
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "FLOW"
    settings = modifier.flow_settings
    settings.flow_type, settings.flow_behavior = kind, behavior
    if speed is not None:
        settings.use_initial_velocity, settings.velocity_coord = True, speed
    return settings


def effector(thing, kind="COLLISION", *, thickness=0.0, planar=False):
    """What a fluid meets (or is guided by). ``planar``: an open mesh."""
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "EFFECTOR"
    settings = modifier.effector_settings
    settings.effector_type, settings.surface_distance, settings.use_plane_init = kind, thickness, planar
    return settings


def bake(fluids_in):
    """Bakes all that there is. Fluids keep their caches below the folder ``fluids_in`` (``//…``), each in its own."""
    scene = bpy.context.scene
    domains = [thing for thing in scene.objects if any(_is_domain(one) for one in thing.modifiers)]
    if scene.rigidbody_world is not None or _cached(scene):
        bpy.ops.ptcache.bake_all(bake=True)
    for hairs in _moving_hair(scene):  # which Blender leaves out when it bakes all
        with bpy.context.temp_override(point_cache=hairs.point_cache):
            bpy.ops.ptcache.bake(bake=True)
    for number, thing in enumerate(domains):
        settings = next(one for one in thing.modifiers if _is_domain(one)).domain_settings
        settings.cache_directory = f"{fluids_in}/{number}"
        with bpy.context.temp_override(object=thing, active_object=thing):
            bpy.ops.fluid.bake_all()


def _is_domain(modifier):
    return modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN"


def _moving_hair(scene):
    systems = [system for thing in scene.objects for system in thing.particle_systems]
    return [system for system in systems if system.settings.type == "HAIR" and system.use_hair_dynamics]


def _cached(scene):
    kinds = {"CLOTH", "SOFT_BODY", "PARTICLE_SYSTEM", "DYNAMIC_PAINT"}
    return any(modifier.type in kinds for thing in scene.objects for modifier in thing.modifiers)
