# SPDX-License-Identifier: GPL-3.0-or-later
"""What simulates, and what takes part: one entry for each, of a ``kind``, with its settings and its cache."""

from array import array
from itertools import compress

from .cache_entries import fluid_cache_facts, nodes_cache_facts, point_cache_facts
from .rna_values import differing, number, numbers, plain, text

MOST_PARTICLES = 200_000  # of one system that are looked at one by one
_ALIVE = 3  # of Particle.alive_state
_SIMULATED = {"EMITTER", "HAIR"}  # other systems show what a fluid has cached
# Several names of RNA stand for one number of a field: what each means, and for which types.
_MEANT_FOR = {
    "linear_drag": "DRAG",
    "quadratic_drag": "DRAG",
    "harmonic_damping": "HARMONIC",
    "rest_length": "HARMONIC",
    "guide_minimum": "GUIDE",
    "inflow": "VORTEX",
    "size": "TURBULENCE TEXTURE",
}


def world_facts(scene):
    """The rigid-body world of a scene; None if it has none."""
    world = scene.rigidbody_world
    if world is None:
        return None
    told = {"kind": "rigid_body_world", "name": text(scene.name)}
    told["bodies"] = len(world.collection.objects) if world.collection is not None else 0
    if world.constraints is not None:
        told["constraints"] = len(world.constraints.objects)
    for setting in ("substeps_per_frame", "solver_iterations", "time_scale"):
        told[setting] = number(getattr(world, setting))
    _settings(told, differing(world, leave=("substeps_per_frame", "solver_iterations", "time_scale")))
    _settings(told, _weights(world.effector_weights))
    if world.point_cache is not None:
        told["cache"] = point_cache_facts(world.point_cache, scene)
    return told


def physics_of(thing, graph):
    """Every part that an object takes in a simulation."""
    if thing.rigid_body is not None:
        yield _rigid_body(thing)
    if thing.rigid_body_constraint is not None:
        yield _rigid_body_constraint(thing)
    if thing.field is not None and thing.field.type != "NONE":
        yield _field(thing, thing.field)
    for modifier in thing.modifiers:
        read = _MODIFIERS.get(modifier.type)
        told = read(thing, modifier, graph) if read is not None else None
        if told is not None:
            told["modifier"] = text(modifier.name)
            off = [word for word in ("viewport", "render") if not getattr(modifier, f"show_{word}")]
            yield {**told, "off": off} if off else told


def _settings(told, found):
    if found:
        told.setdefault("settings", {}).update(found)
    return told


def _weights(weights):
    """What of gravity and of force fields does not reach a simulation as it is."""
    return (
        {f"effector_weights.{name}": value for name, value in differing(weights).items()} if weights else {}
    )


def _rigid_body(thing):
    body = thing.rigid_body
    told = {
        "kind": "rigid_body",
        "name": text(thing.name),
        "type": body.type,
        "shape": body.collision_shape,
        "mass": number(body.mass),
    }
    if body.kinematic:
        told["animated"] = True
    return _settings(told, differing(body))


def _rigid_body_constraint(thing):
    joint = thing.rigid_body_constraint
    ends = [text(end.name) if end is not None else None for end in (joint.object1, joint.object2)]
    told = {"kind": "rigid_body_constraint", "name": text(thing.name), "type": joint.type, "objects": ends}
    return _settings(told, differing(joint, leave=("object1", "object2")))


def _field(thing, field):
    told = {
        "kind": "force_field",
        "name": text(thing.name),
        "type": field.type,
        "strength": number(field.strength),
    }
    others = [name for name, types in _MEANT_FOR.items() if field.type not in types.split()]
    return _settings(told, differing(field, leave=("strength", *others), variant=field.type))


def _cloth(thing, modifier, _graph):
    told = {"kind": "cloth", "name": text(thing.name)}
    _settings(told, differing(modifier.settings))
    _settings(told, _weights(modifier.settings.effector_weights))
    collisions = differing(modifier.collision_settings)
    _settings(told, {f"collision_settings.{name}": value for name, value in collisions.items()})
    return {**told, "cache": point_cache_facts(modifier.point_cache, thing)}


def _soft_body(thing, modifier, _graph):
    told = {"kind": "soft_body", "name": text(thing.name)}
    _settings(told, differing(modifier.settings))
    _settings(told, _weights(modifier.settings.effector_weights))
    return {**told, "cache": point_cache_facts(modifier.point_cache, thing)}


def _collision(thing, _modifier, _graph):
    if thing.collision is None:
        return None
    return _settings({"kind": "collision", "name": text(thing.name)}, differing(thing.collision))


def _nodes(thing, modifier, _graph):
    if not len(getattr(modifier, "bakes", ())):
        return None
    caches = [nodes_cache_facts(modifier, bake) for bake in modifier.bakes]
    return {"kind": "nodes_simulation", "name": text(thing.name), "caches": caches[:8]}


def _particles(thing, modifier, graph):
    system = modifier.particle_system
    settings = system.settings
    told = {"kind": "particles", "name": text(thing.name), "system": text(system.name)}
    if settings is None:
        return told
    told.update(
        data=text(settings.name),
        type=settings.type,
        particles=settings.count,
        emission=[number(settings.frame_start), number(settings.frame_end)],
        lifetime=number(settings.lifetime),
    )
    told.update(_alive(thing, system, graph))
    _settings(told, differing(settings))
    _settings(told, differing(system, leave=("settings",)))
    _settings(told, _weights(settings.effector_weights))
    if settings.type in _SIMULATED and (settings.type != "HAIR" or system.use_hair_dynamics):
        told["cache"] = point_cache_facts(system.point_cache, thing)
    return told


def _alive(thing, system, graph):
    """How many particles live at this frame, and between which corners."""
    evaluated = thing.evaluated_get(graph)
    found = evaluated.particle_systems.get(system.name) if evaluated.is_evaluated else None
    count = len(found.particles) if found is not None else 0
    if not count or count > MOST_PARTICLES or system.settings.type == "HAIR":
        return {}
    states, places = array("i", bytes(4 * count)), array("f", bytes(12 * count))
    found.particles.foreach_get("alive_state", states)
    found.particles.foreach_get("location", places)
    alive = [state == _ALIVE for state in states]
    told = {"alive": sum(alive)}
    if told["alive"]:
        ends = [
            (min(axis), max(axis)) for start in range(3) for axis in [list(compress(places[start::3], alive))]
        ]
        told["between"] = [numbers(low for low, _ in ends), numbers(high for _, high in ends)]
    return told


def _fluid(thing, modifier, _graph):
    kind = modifier.fluid_type
    settings = getattr(modifier, f"{kind.lower()}_settings", None) if kind != "NONE" else None
    if settings is None:
        return {"kind": "fluid", "name": text(thing.name), "type": "NONE"}
    told = {"kind": f"fluid_{kind.lower()}", "name": text(thing.name)}
    if kind != "DOMAIN":
        own = "flow_type" if kind == "FLOW" else "effector_type"
        told["type"] = getattr(settings, own)
        return _settings(told, differing(settings, leave=(own,), variant=told["type"]))
    told["type"] = settings.domain_type
    told["resolution"] = settings.resolution_max
    _settings(told, differing(settings, variant=settings.domain_type))
    _settings(told, _weights(settings.effector_weights))
    return {**told, "cache": fluid_cache_facts(settings)}


def _paint(thing, modifier, _graph):
    told = {"kind": "dynamic_paint", "name": text(thing.name), "type": modifier.ui_type}
    canvas = modifier.canvas_settings
    if canvas is not None:
        told["surfaces"] = [
            {
                "name": text(surface.name),
                "type": surface.surface_type,
                **({"settings": settings} if (settings := differing(surface)) else {}),
                "cache": point_cache_facts(surface.point_cache, thing),
            }
            for surface in list(canvas.canvas_surfaces)[:8]
        ]
    brush = modifier.brush_settings
    if brush is not None:
        told["brush"] = plain(brush.paint_source)
    return told


_MODIFIERS = {
    "CLOTH": _cloth,
    "SOFT_BODY": _soft_body,
    "COLLISION": _collision,
    "PARTICLE_SYSTEM": _particles,
    "FLUID": _fluid,
    "DYNAMIC_PAINT": _paint,
    "NODES": _nodes,
}
