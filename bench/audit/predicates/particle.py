"""Particles: systems, their source, collisions and force fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from bench.audit.predicates.predicate import Params, Verdict, judged
from bench.audit.predicates.shared_readings import (
    admits,
    blows,
    cache_seen,
    collides,
    is_filled,
    members,
    number,
    partners_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Object, Particles
    from bench.audit.predicates.predicate import Stage, Unit
    from bench.audit.predicates.shared_readings import Partners

# Modifiers that give a surface another shape, or another shape at each frame.
DEFORMERS = (
    "ARMATURE", "CAST", "CLOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LATTICE", "MESH_CACHE", "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE", "NODES", "OCEAN", "SHRINKWRAP", "SIMPLE_DEFORM", "SOFT_BODY", "SURFACE_DEFORM", "WARP",
    "WAVE",
)  # fmt: skip


SourceKind = Literal["VERT", "FACE", "VOLUME"]


class SystemType(Params):
    """``type``: EMITTER or HAIR."""

    type: Literal["EMITTER", "HAIR"] = "EMITTER"


class Source(Params):
    """``source``: VERT, FACE, VOLUME, or a list of accepted ones (None: any). ``min``: least number of particles."""

    source: SourceKind | tuple[SourceKind, ...] | None = None
    min: int = Field(default=1, ge=1)


class Deformer(Params):
    """``deformer``: the modifier's type; None: any that deforms."""

    deformer: str | None = None


FieldType = Literal[
    "FORCE", "WIND", "VORTEX", "MAGNET", "HARMONIC", "CHARGE", "LENNARDJ", "TEXTURE", "GUIDE", "BOID", "TURBULENCE",
    "DRAG", "FLUID_FLOW",
]  # fmt: skip


class Fields(Params):
    """``min``: how many at least. ``types``: those that count (WIND, TURBULENCE, …); an empty list: all."""

    min: int = Field(default=1, ge=1)
    types: tuple[FieldType, ...] = ()


def _systems(unit: Unit) -> Iterator[tuple[Object, Particles]]:
    """Emitters and hair: systems of other types show what a fluid has."""
    for one, modifier in unit.modifiers("PARTICLE_SYSTEM"):
        if modifier.particles is not None and modifier.particles.type in ("EMITTER", "HAIR"):
            yield one, modifier.particles


def particle_system(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor has its own particle system: an emitter or hair, on or off (see solver_enabled). A system that only
    shows the particles of a fluid does not count.
    """
    del stage, params
    found = [f"{one.name}: {system.name}" for one, system in _systems(unit)]
    return judged(found, systems=found[:8])


def particle_type(unit: Unit, stage: Stage, params: SystemType) -> Verdict:
    """The actor's particles are of the required kind: one of its systems is of that type, EMITTER for particles that
    are born and die, HAIR for strands that stay in place.
    """
    del stage
    found = [system.type for _, system in _systems(unit)]
    return judged(params.type in found, types=found[:8])


def particle_source(unit: Unit, stage: Stage, params: Source) -> Verdict:
    """The actor does emit particles: one of its systems has at least ``min`` of them, the required source (vertices,
    faces, volume), a mesh that has such elements, and, for an emitter, births within the clip.
    """
    seen = [
        {
            "system": system.name,
            "count": system.count,
            "source": system.source,
            "emission": [number(frame) for frame in system.emission],
            "faces": one.faces,
        }
        for one, system in _systems(unit)
    ]
    return judged(
        any(_comes_out(one, system, stage, params) for one, system in _systems(unit)), systems=seen[:8]
    )


def _comes_out(one: Object, system: Particles, stage: Stage, params: Source) -> bool:
    first, last = stage.scene.range
    born = system.type == "HAIR" or (system.emission[0] <= last and system.emission[1] >= first)
    has_source = one.vertices > 0 if system.source == "VERT" else one.faces > 0
    return system.count >= params.min and admits(params.source, system.source) and has_source and born


def particle_cache_baked(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The particles' motion is baked: the cache of one of the actor's emitters, or of its hair with dynamics, is marked
    as baked, its range covers 95 % of the scene's frames and of the clip's minimum length, and it holds 95 % of the
    frames in which there are particles. Frames before the first birth do not count, since Blender starts the cache
    there. Hair without dynamics has no cache and fails.
    """
    del params
    found = [(system.cache, system) for _, system in _systems(unit) if system.cache is not None]
    filled = [cache for cache, system in found if is_filled(cache, stage, _since(system))]
    return judged(filled, caches=[cache_seen(cache, stage) for cache, _ in found][:4])


def _since(system: Particles) -> float | None:
    """When its first particle is born; hair is there from the start."""
    return system.emission[0] if system.type == "EMITTER" else None


def particle_collision_partners(unit: Unit, stage: Stage, params: Partners) -> Verdict:
    """The particles collide with their partners: each partner (if none is named: at least one other object) has an
    object with a COLLISION modifier that is on and, if the particles have a collision collection, is in it. Particles
    fly through anything without this modifier.
    """
    seen: dict[str, list[str]] = {}
    for _, system in _systems(unit):
        within = members(stage.scene, system.effectors.collisions)
        for name, objects in partners_of(unit, stage, params.partners):
            found = [one.name for one in objects if collides(one) and (within is None or one.name in within)]
            seen.setdefault(name, []).extend(found[:8])
    return judged(seen and all(seen.values()), carry_collision=seen)


def particle_from_deformed(unit: Unit, stage: Stage, params: Deformer) -> Verdict:
    """Particles come from the deformed surface: on one object, a deforming modifier (the required one, or any) is on
    and stands above the particle system in the modifier stack. Particles are born on the mesh as it is at their place
    in the stack; a deformer further down would move the surface away from them.
    """
    del stage
    wanted = (params.deformer,) if params.deformer else DEFORMERS
    seen: dict[str, list[str]] = {}
    holds = False
    for one in unit.objects:
        order = [modifier.type for modifier in one.modifiers]
        if "PARTICLE_SYSTEM" not in order:
            continue
        seen[one.name] = order
        before = one.modifiers[: len(order) - 1 - order[::-1].index("PARTICLE_SYSTEM")]
        holds = holds or any(modifier.type in wanted and modifier.on for modifier in before)
    return judged(holds, stacks=dict(sorted(seen.items())[:4]))


def particle_force_fields(unit: Unit, stage: Stage, params: Fields) -> Verdict:
    """Force fields move the particles: at least ``min`` objects of the scene have a force field of a required type,
    with a strength that is not zero or is animated, that acts on the actor's particles: it is in their effector
    collection if they have one, and their weights for this field type and for all fields are above zero.
    """
    found: set[str] = set()
    for _, system in _systems(unit):
        within = members(stage.scene, system.effectors.fields)
        weights = system.effectors.weights
        for one in stage.scene.objects:
            force = one.force
            if force is None or not blows(one) or (params.types and force.type not in params.types):
                continue
            weight = weights.get("ALL", 1.0) * weights.get(force.type, 1.0)
            if weight > 0 and (within is None or one.name in within):
                found.add(f"{one.name}: {force.type}")
    return judged(len(found) >= params.min, fields=sorted(found)[:8], min=params.min)
