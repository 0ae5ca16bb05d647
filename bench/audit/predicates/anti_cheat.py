"""Signs of an imitated simulation, and of physics in a static scene. Specs list all of them as ``must_not_have``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.facts import SOLVERS
from bench.audit.predicates.predicate import Verdict, judged
from bench.audit.predicates.shared_readings import number
from bench.audit.roles import simulates

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Channel, Modifier, Object
    from bench.audit.predicates.predicate import Params, Stage, Unit

# Hand-made animation has a key every 8 to 12 frames; sampled motion has one every frame or two. One key in four frames
# separates the two with a margin on either side.
DENSE_KEYS_PER_FRAME = 0.25
# A push or a release takes a handful of keys close together: fewer than this many are not a recording.
DENSE_LEAST_KEYS = 8
_TRANSFORMS = ("location", "rotation", "scale", "delta_")
# Constraints that move an object without keys of its own.
_MOVERS = ("TRANSFORM_CACHE", "FOLLOW_PATH", "FOLLOW_TRACK", "OBJECT_SOLVER", "ACTION")
_GEOMETRY_CACHES = ("MESH_CACHE", "MESH_SEQUENCE_CACHE")
_MOST_FOLLOWED = 64


def dense_transform_keys(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor is moved by recorded motion. One of its objects has a location, rotation or scale that varies and is
    densely keyed: at least 8 keys (or samples) in its action or NLA strips, with at least one key per 4 frames between
    the first and the last. A driver or an f-curve modifier, which sets a value at every frame, counts too, and so does
    a constraint that plays a path, a track or a cache. If no solver moves the actor, the objects that it follows
    (parents, armatures, constraint targets) are checked as well, since they move it. Animation by hand has a key every
    8 to 12 frames; an exported simulation has one at every frame.
    """
    del params
    moved_by_solver = any(simulates(one, stage.scene) for one in unit.objects)
    looked_at = unit.objects if moved_by_solver else (*unit.objects, *_followed(unit, stage))
    found: dict[str, Any] = {}
    for one in looked_at:
        for channel in one.channels:
            if channel.path.rpartition(".")[2].startswith(_TRANSFORMS) and is_dense(channel):
                found[f"{one.name}: {channel.path}"] = _channel_seen(channel)
        for constraint in one.constraints:
            if constraint.type in _MOVERS:
                found[f"{one.name}: {constraint.type}"] = list(constraint.targets[:2])
    return judged(found, dense=dict(sorted(found.items())[:8]), solver=moved_by_solver)


def is_dense(channel: Channel) -> bool:
    """Whether a channel is densely keyed, or has a value generated at every frame."""
    if not channel.varies:
        return False
    dense = channel.keys >= DENSE_LEAST_KEYS and channel.keys >= DENSE_KEYS_PER_FRAME * (channel.span + 1)
    return channel.generated or dense


def _channel_seen(channel: Channel) -> dict[str, Any]:
    return {
        "way": channel.way,
        "keys": channel.keys,
        "frames": number(channel.span),
        "generated": channel.generated,
    }


def _followed(unit: Unit, stage: Stage) -> Iterator[Object]:
    by_name = {one.name: one for one in stage.scene.objects}
    seen = set(unit.names)
    waiting = [name for one in unit.objects for name in one.follows]
    while waiting and len(seen) < len(unit.names) + _MOST_FOLLOWED:
        name = waiting.pop(0)
        if name in seen or name not in by_name:
            continue
        seen.add(name)
        yield by_name[name]
        waiting += by_name[name].follows


def animated_shape_keys(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor's surface is moved by stored shapes instead of a solver. One of its objects has shape keys whose values
    vary over the clip (keys, drivers, NLA), keyed vertices, or a modifier that plays a mesh from a file (mesh cache,
    Alembic or USD) and is on in the viewport or in renders. The number of keys does not matter: two are enough to
    blend one shape into another.
    """
    del stage, params
    found: dict[str, Any] = {}
    for one in unit.objects:
        for channel in one.shape_channels:
            if channel.varies:
                found[f"{one.name}: {channel.path}"] = _channel_seen(channel)
        for modifier in one.of_type(*_GEOMETRY_CACHES):
            if modifier.show_viewport or modifier.show_render:
                found[f"{one.name}: {modifier.name}"] = modifier.type
    return judged(found, animated=dict(sorted(found.items())[:8]))


def static_has_cache(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """Something in the scene is baked: the point cache of a cloth, soft body, particle system or rigid-body world is
    marked as baked, or a fluid is marked as baked or has frames on disk. A static scene has nothing to bake.
    """
    del unit, params
    found: list[str] = []
    for one, modifier in _solvers(stage):
        caches = [part.cache for part in (modifier.cloth, modifier.soft, modifier.particles) if part]
        domain = modifier.fluid.domain if modifier.fluid else None
        if any(cache and cache.is_baked for cache in caches) or (
            domain and (domain.cache.baked or domain.cache.parts)
        ):
            found.append(f"{one.name}: {modifier.name}")
    world = stage.scene.rigid_world
    if world is not None and world.cache.is_baked:
        found.append("rigid-body world")
    return judged(found, baked=sorted(found)[:8])


def static_has_rigid_world(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The scene has a rigid-body world with at least one body in it. An empty world does nothing and is allowed."""
    del unit, params
    bodies = [
        one.name for one in stage.scene.objects if one.rigid_body is not None and one.rigid_body.in_world
    ]
    return judged(bodies, bodies=len(bodies), some=bodies[:8])


def static_has_solver(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """An object of the scene has a modifier that simulates (cloth, soft body, fluid, particles, dynamic paint), on or
    off. Two things are allowed: hair without dynamics, which rugs and grass are made of, and collision modifiers, which
    move nothing.
    """
    del unit, params
    found = sorted(f"{one.name}: {modifier.type}" for one, modifier in _solvers(stage))
    return judged(found, solvers=found[:8], count=len(found))


def _solvers(stage: Stage) -> Iterator[tuple[Object, Modifier]]:
    for one in stage.scene.objects:
        for modifier in one.of_type(*SOLVERS):
            grown = modifier.particles
            if grown is None or grown.type != "HAIR" or grown.hair_dynamics:
                yield one, modifier
