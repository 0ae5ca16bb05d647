# SPDX-License-Identifier: GPL-3.0-or-later
"""Physics in a readout: an entry with ``kind``, settings and cache for everything that takes part in a simulation."""

from array import array
from itertools import compress

from .cache_entries import fluid_cache_facts, nodes_cache_facts, point_cache_facts
from .rna_values import changed_settings, number, numbers, text, to_json

MOST_PARTICLES = 200_000  # of one system that are read
_ALIVE = 3  # of Particle.alive_state
_SIMULATED = {"EMITTER", "HAIR"}  # other types show a fluid's particles
# RNA has several names for the same number of a field: the field types for which each name is right.
_MEANT_FOR = {
    "linear_drag": "DRAG",
    "quadratic_drag": "DRAG",
    "harmonic_damping": "HARMONIC",
    "rest_length": "HARMONIC",
    "guide_minimum": "GUIDE",
    "inflow": "VORTEX",
    "size": "TURBULENCE TEXTURE",
}


def rigid_body_world_facts(scene):
    """The rigid-body world of a scene; None if it has none."""
    world = scene.rigidbody_world
    if world is None:
        return None
    entry = {"kind": "rigid_body_world", "name": text(scene.name)}
    entry["bodies"] = len(world.collection.objects) if world.collection is not None else 0
    if world.constraints is not None:
        entry["constraints"] = len(world.constraints.objects)
    for setting in ("substeps_per_frame", "solver_iterations", "time_scale"):
        entry[setting] = number(getattr(world, setting))
    _add_settings(
        entry, changed_settings(world, leave=("substeps_per_frame", "solver_iterations", "time_scale"))
    )
    _add_settings(entry, _weights(world.effector_weights))
    if world.point_cache is not None:
        entry["cache"] = point_cache_facts(world.point_cache, scene)
    return entry


def physics_of(obj, graph):
    """Yields an entry for every part that an object has in a simulation."""
    if obj.rigid_body is not None:
        yield _rigid_body(obj)
    if obj.rigid_body_constraint is not None:
        yield _rigid_body_constraint(obj)
    if obj.field is not None and obj.field.type != "NONE":
        yield _field(obj, obj.field)
    for modifier in obj.modifiers:
        read = _MODIFIERS.get(modifier.type)
        entry = read(obj, modifier, graph) if read is not None else None
        if entry is not None:
            entry["modifier"] = text(modifier.name)
            off = [word for word in ("viewport", "render") if not getattr(modifier, f"show_{word}")]
            yield {**entry, "off": off} if off else entry


def _add_settings(entry, settings):
    if settings:
        entry.setdefault("settings", {}).update(settings)
    return entry


def _weights(weights):
    """The effector weights that are not 1."""
    return (
        {f"effector_weights.{name}": value for name, value in changed_settings(weights).items()}
        if weights
        else {}
    )


def _rigid_body(obj):
    body = obj.rigid_body
    entry = {
        "kind": "rigid_body",
        "name": text(obj.name),
        "type": body.type,
        "shape": body.collision_shape,
        "mass": number(body.mass),
    }
    if body.kinematic:
        entry["animated"] = True
    settings = changed_settings(body)
    if "collision_collections" in settings:
        settings["collision_collections"] = [at for at, on in enumerate(body.collision_collections) if on]
    return _add_settings(entry, settings)


def _rigid_body_constraint(obj):
    joint = obj.rigid_body_constraint
    ends = [text(end.name) if end is not None else None for end in (joint.object1, joint.object2)]
    entry = {"kind": "rigid_body_constraint", "name": text(obj.name), "type": joint.type, "objects": ends}
    return _add_settings(entry, changed_settings(joint, leave=("object1", "object2")))


def _field(obj, field):
    entry = {
        "kind": "force_field",
        "name": text(obj.name),
        "type": field.type,
        "strength": number(field.strength),
    }
    others = [name for name, types in _MEANT_FOR.items() if field.type not in types.split()]
    return _add_settings(entry, changed_settings(field, leave=("strength", *others), variant=field.type))


def _cloth(obj, modifier, _graph):
    entry = {"kind": "cloth", "name": text(obj.name)}
    _add_settings(entry, changed_settings(modifier.settings))
    _add_settings(entry, _weights(modifier.settings.effector_weights))
    collisions = changed_settings(modifier.collision_settings)
    _add_settings(entry, {f"collision_settings.{name}": value for name, value in collisions.items()})
    return {**entry, "cache": point_cache_facts(modifier.point_cache, obj)}


def _soft_body(obj, modifier, _graph):
    entry = {"kind": "soft_body", "name": text(obj.name)}
    _add_settings(entry, changed_settings(modifier.settings))
    _add_settings(entry, _weights(modifier.settings.effector_weights))
    return {**entry, "cache": point_cache_facts(modifier.point_cache, obj)}


def _collision(obj, _modifier, _graph):
    if obj.collision is None:
        return None
    return _add_settings({"kind": "collision", "name": text(obj.name)}, changed_settings(obj.collision))


def _nodes(obj, modifier, _graph):
    if not len(getattr(modifier, "bakes", ())):
        return None
    caches = [nodes_cache_facts(modifier, bake) for bake in modifier.bakes]
    return {"kind": "nodes_simulation", "name": text(obj.name), "caches": caches[:8]}


def _particles(obj, modifier, graph):
    system = modifier.particle_system
    settings = system.settings
    entry = {"kind": "particles", "name": text(obj.name), "system": text(system.name)}
    if settings is None:
        return entry
    entry.update(
        data=text(settings.name),
        type=settings.type,
        particles=settings.count,
        emission=[number(settings.frame_start), number(settings.frame_end)],
        lifetime=number(settings.lifetime),
    )
    entry.update(_alive(obj, system, graph))
    _add_settings(entry, changed_settings(settings))
    _add_settings(entry, changed_settings(system, leave=("settings",)))
    _add_settings(entry, _weights(settings.effector_weights))
    if settings.type in _SIMULATED and (settings.type != "HAIR" or system.use_hair_dynamics):
        entry["cache"] = point_cache_facts(system.point_cache, obj)
    return entry


def _alive(obj, system, graph):
    """How many particles are alive at this frame, and the corners of their bounding box."""
    evaluated = obj.evaluated_get(graph)
    evaluated_system = evaluated.particle_systems.get(system.name) if evaluated.is_evaluated else None
    count = len(evaluated_system.particles) if evaluated_system is not None else 0
    if not count or count > MOST_PARTICLES or system.settings.type == "HAIR":
        return {}
    states, places = array("i", bytes(4 * count)), array("f", bytes(12 * count))
    evaluated_system.particles.foreach_get("alive_state", states)
    evaluated_system.particles.foreach_get("location", places)
    alive = [state == _ALIVE for state in states]
    entry = {"alive": sum(alive)}
    if entry["alive"]:
        ends = [
            (min(axis), max(axis)) for start in range(3) for axis in [list(compress(places[start::3], alive))]
        ]
        entry["between"] = [numbers(low for low, _ in ends), numbers(high for _, high in ends)]
    return entry


def _fluid(obj, modifier, _graph):
    kind = modifier.fluid_type
    settings = getattr(modifier, f"{kind.lower()}_settings", None) if kind != "NONE" else None
    if settings is None:
        return {"kind": "fluid", "name": text(obj.name), "type": "NONE"}
    entry = {"kind": f"fluid_{kind.lower()}", "name": text(obj.name)}
    if kind != "DOMAIN":
        own = "flow_type" if kind == "FLOW" else "effector_type"
        entry["type"] = getattr(settings, own)
        return _add_settings(entry, changed_settings(settings, leave=(own,), variant=entry["type"]))
    entry["type"] = settings.domain_type
    entry["resolution"] = settings.resolution_max
    _add_settings(entry, changed_settings(settings, variant=settings.domain_type))
    _add_settings(entry, _weights(settings.effector_weights))
    return {**entry, "cache": fluid_cache_facts(settings)}


def _paint(obj, modifier, _graph):
    entry = {"kind": "dynamic_paint", "name": text(obj.name), "type": modifier.ui_type}
    canvas = modifier.canvas_settings
    if canvas is not None:
        entry["surfaces"] = [
            {
                "name": text(surface.name),
                "type": surface.surface_type,
                **({"settings": settings} if (settings := changed_settings(surface)) else {}),
                "cache": point_cache_facts(surface.point_cache, obj),
            }
            for surface in list(canvas.canvas_surfaces)[:8]
        ]
    brush = modifier.brush_settings
    if brush is not None:
        entry["brush"] = to_json(brush.paint_source)
    return entry


_MODIFIERS = {
    "CLOTH": _cloth,
    "SOFT_BODY": _soft_body,
    "COLLISION": _collision,
    "PARTICLE_SYSTEM": _particles,
    "FLUID": _fluid,
    "DYNAMIC_PAINT": _paint,
    "NODES": _nodes,
}
