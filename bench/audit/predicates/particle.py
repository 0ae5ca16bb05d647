"""Particles: systems, where they come from, what they meet and what moves them."""

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
    """``source``: VERT, FACE, VOLUME, or several that will do (None: any). ``min``: how many particles at least."""

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
    """``min``: how many; ``types``: those that count (WIND, TURBULENCE, …); of none, all."""

    min: int = Field(default=1, ge=1)
    types: tuple[FieldType, ...] = ()


def _systems(unit: Unit) -> Iterator[tuple[Object, Particles]]:
    """Emitters and hair: systems of other types show what a fluid has."""
    for one, modifier in unit.modifiers("PARTICLE_SYSTEM"):
        if modifier.particles is not None and modifier.particles.type in ("EMITTER", "HAIR"):
            yield one, modifier.particles


def particle_system(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor has a particle system of its own: an emitter or hair, on or off (see solver_enabled); not one that
    only shows the particles of a fluid.
    """
    del stage, params
    found = [f"{one.name}: {system.name}" for one, system in _systems(unit)]
    return judged(found, systems=found[:8])


def particle_type(unit: Unit, stage: Stage, params: SystemType) -> Verdict:
    """The actor's particles are of the kind that is asked for: one of its systems is of that type, EMITTER for what
    is born and dies, HAIR for what stays where it grew.
    """
    del stage
    found = [system.type for _, system in _systems(unit)]
    return judged(params.type in found, types=found[:8])


def particle_source(unit: Unit, stage: Stage, params: Source) -> Verdict:
    """Particles do come out of the actor: one of its systems has at least ``min`` of them, the source that is asked
    for (vertices, faces, volume), a mesh that has it, and, for an emitter, a birth within the clip.
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
    """The particles' motion is kept: the cache of one of its emitters, or of its hair with dynamics, is marked as
    baked, its range covers 95 % of the scene's frames and of the least length of the clip, not counting those before
    the first particle is born (Blender begins the cache there), and it holds 95 % of the frames in which there are
    particles. Hair without dynamics has no cache, and fails.
    """
    del params
    found = [(system.cache, system) for _, system in _systems(unit) if system.cache is not None]
    filled = [cache for cache, system in found if is_filled(cache, stage, _since(system))]
    return judged(filled, caches=[cache_seen(cache, stage) for cache, _ in found][:4])


def _since(system: Particles) -> float | None:
    """When its first particle is born; hair is there from the start."""
    return system.emission[0] if system.type == "EMITTER" else None


def particle_collision_partners(unit: Unit, stage: Stage, params: Partners) -> Verdict:
    """What the particles meet can stop them: each partner (without any: at least one other object) has an object with
    a COLLISION modifier that is on, within the collision collection of the particles where there is one. Particles
    fly through whatever carries no such modifier.
    """
    seen: dict[str, list[str]] = {}
    for _, system in _systems(unit):
        within = members(stage.scene, system.effectors.collisions)
        for name, objects in partners_of(unit, stage, params.partners):
            found = [one.name for one in objects if collides(one) and (within is None or one.name in within)]
            seen.setdefault(name, []).extend(found[:8])
    return judged(seen and all(seen.values()), carry_collision=seen)


def particle_from_deformed(unit: Unit, stage: Stage, params: Deformer) -> Verdict:
    """Particles come from the surface as it is deformed: on one object, a modifier that deforms (the one asked for,
    or any) that is on stands before the particle system's in the stack. Particles are born on the mesh as it is where
    their modifier stands; below it, the surface moves away from under them.
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
    """Something moves the particles besides gravity: at least ``min`` objects of the scene have a force field of the
    types asked for, with a strength other than zero or an animated one, that reaches the actor's particles: in the
    collection of their effectors, where they have one, and with a weight above zero for such fields and for all.
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
