"""Particles: systems, their source, collisions and force fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from bench.audit.predicates.predicate import PredicateParams, PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import (
    admits,
    blows,
    cache_seen,
    colliding_partners,
    is_filled,
    members,
    number,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Object, Particles
    from bench.audit.predicates.predicate import AuditContext, Unit
    from bench.audit.predicates.shared_readings import Partners

# Modifiers that give a surface another shape, or another shape at each frame.
DEFORMERS = (
    "ARMATURE", "CAST", "CLOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LATTICE", "MESH_CACHE", "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE", "NODES", "OCEAN", "SHRINKWRAP", "SIMPLE_DEFORM", "SOFT_BODY", "SURFACE_DEFORM", "WARP",
    "WAVE",
)  # fmt: skip


SourceKind = Literal["VERT", "FACE", "VOLUME"]


class SystemType(PredicateParams):
    """``type``: EMITTER or HAIR."""

    type: Literal["EMITTER", "HAIR"] = "EMITTER"


class ParticleSource(PredicateParams):
    """``source``: VERT, FACE, VOLUME, or a list of accepted ones (None: any). ``min``: least number of particles."""

    source: SourceKind | tuple[SourceKind, ...] | None = None
    min: int = Field(default=1, ge=1)


class Deformer(PredicateParams):
    """``deformer``: the modifier's type; None: any that deforms."""

    deformer: str | None = None


FieldType = Literal[
    "FORCE", "WIND", "VORTEX", "MAGNET", "HARMONIC", "CHARGE", "LENNARDJ", "TEXTURE", "GUIDE", "BOID", "TURBULENCE",
    "DRAG", "FLUID_FLOW",
]  # fmt: skip


class FieldCount(PredicateParams):
    """``min``: how many at least. ``types``: those that count (WIND, TURBULENCE, …); an empty list: all."""

    min: int = Field(default=1, ge=1)
    types: tuple[FieldType, ...] = ()


def _systems(unit: Unit) -> Iterator[tuple[Object, Particles]]:
    """Emitters and hair: systems of other types show what a fluid has."""
    for obj, modifier in unit.modifiers("PARTICLE_SYSTEM"):
        if modifier.particles is not None and modifier.particles.type in ("EMITTER", "HAIR"):
            yield obj, modifier.particles


def particle_system(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor has its own particle system: an emitter or hair, on or off (see solver_enabled). A system that only
    shows the particles of a fluid does not count.
    """
    del context, params
    names = [f"{obj.name}: {system.name}" for obj, system in _systems(unit)]
    return verdict_of(names, systems=names[:8])


def particle_type(unit: Unit, context: AuditContext, params: SystemType) -> PredicateVerdict:
    """The actor's particles are of the required kind: one of its systems is of that type, EMITTER for particles that
    are born and die, HAIR for strands that stay in place.
    """
    del context
    types = [system.type for _, system in _systems(unit)]
    return verdict_of(params.type in types, types=types[:8])


def particle_source(unit: Unit, context: AuditContext, params: ParticleSource) -> PredicateVerdict:
    """The actor does emit particles: one of its systems has at least ``min`` of them, the required source (vertices,
    faces, volume), a mesh that has such elements, and, for an emitter, births within the clip.
    """
    seen = [
        {
            "system": system.name,
            "count": system.count,
            "source": system.source,
            "emission": [number(frame) for frame in system.emission],
            "faces": obj.faces,
        }
        for obj, system in _systems(unit)
    ]
    return verdict_of(
        any(_comes_out(obj, system, context, params) for obj, system in _systems(unit)), systems=seen[:8]
    )


def _comes_out(obj: Object, system: Particles, context: AuditContext, params: ParticleSource) -> bool:
    first, last = context.scene.range
    born = system.type == "HAIR" or (system.emission[0] <= last and system.emission[1] >= first)
    has_source = obj.vertices > 0 if system.source == "VERT" else obj.faces > 0
    return system.count >= params.min and admits(params.source, system.source) and has_source and born


def particle_cache_baked(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The particles' motion is baked: the cache of one of the actor's emitters, or of its hair with dynamics, is marked
    as baked, its range covers 95 % of the scene's frames and of the clip's minimum length, and it holds 95 % of the
    frames in which there are particles. Frames before the first birth do not count, since Blender starts the cache
    there. Hair without dynamics has no cache and fails.
    """
    del params
    caches = [(system.cache, system) for _, system in _systems(unit) if system.cache is not None]
    filled = [cache for cache, system in caches if is_filled(cache, context, _since(system))]
    return verdict_of(filled, caches=[cache_seen(cache, context) for cache, _ in caches][:4])


def _since(system: Particles) -> float | None:
    """When its first particle is born; hair is there from the start."""
    return system.emission[0] if system.type == "EMITTER" else None


def particle_collision_partners(unit: Unit, context: AuditContext, params: Partners) -> PredicateVerdict:
    """The particles collide with their partners: each partner (if none is named: at least one other object) has an
    object with a COLLISION modifier that is on and, if the particles have a collision collection, is in it. Particles
    fly through anything without this modifier.
    """
    effectors = [system.effectors for _, system in _systems(unit)]
    seen = colliding_partners(unit, context, params.partners, effectors)
    return verdict_of(seen and all(seen.values()), carry_collision=seen)


def particle_from_deformed(unit: Unit, context: AuditContext, params: Deformer) -> PredicateVerdict:
    """Particles come from the deformed surface: on one object, a deforming modifier (the required one, or any) is on
    and stands above the particle system in the modifier stack. Particles are born on the mesh as it is at their place
    in the stack; a deformer further down would move the surface away from them.
    """
    del context
    wanted = (params.deformer,) if params.deformer else DEFORMERS
    seen: dict[str, list[str]] = {}
    holds = False
    for obj in unit.objects:
        order = [modifier.type for modifier in obj.modifiers]
        if "PARTICLE_SYSTEM" not in order:
            continue
        seen[obj.name] = order
        before = obj.modifiers[: len(order) - 1 - order[::-1].index("PARTICLE_SYSTEM")]
        holds = holds or any(modifier.type in wanted and modifier.on for modifier in before)
    return verdict_of(holds, stacks=dict(sorted(seen.items())[:4]))


def particle_force_fields(unit: Unit, context: AuditContext, params: FieldCount) -> PredicateVerdict:
    """Force fields move the particles: at least ``min`` objects of the scene have a force field of a required type,
    with a strength that is not zero or is animated, that acts on the actor's particles: it is in their effector
    collection if they have one, and their weights for this field type and for all fields are above zero.
    """
    fields: set[str] = set()
    for _, system in _systems(unit):
        within = members(context.scene, system.effectors.fields)
        weights = system.effectors.weights
        for obj in context.scene.objects:
            force = obj.force
            if force is None or not blows(obj) or (params.types and force.type not in params.types):
                continue
            weight = weights.get("ALL", 1.0) * weights.get(force.type, 1.0)
            if weight > 0 and (within is None or obj.name in within):
                fields.add(f"{obj.name}: {force.type}")
    return verdict_of(len(fields) >= params.min, fields=sorted(fields)[:8], min=params.min)
