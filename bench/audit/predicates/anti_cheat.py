"""Signs of an imitated simulation, and of physics in a static scene. Specs list all of them as ``must_not_have``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.facts import SOLVERS
from bench.audit.predicates.predicate import PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import number
from bench.audit.roles import simulates

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Channel, Modifier, Object
    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit

# Hand-made animation has a key every 8 to 12 frames; sampled motion has one every frame or two. One key in four frames
# separates the two with a margin on either side.
DENSE_KEYS_PER_FRAME = 0.25
# A push or a release takes a handful of keys close together: fewer than this many are not a recording.
DENSE_LEAST_KEYS = 8
_TRANSFORMS = ("location", "rotation", "scale", "delta_")
# Constraints that move an object without keys of its own.
_MOVING_CONSTRAINTS = ("TRANSFORM_CACHE", "FOLLOW_PATH", "FOLLOW_TRACK", "OBJECT_SOLVER", "ACTION")
_GEOMETRY_CACHES = ("MESH_CACHE", "MESH_SEQUENCE_CACHE")
_MOST_FOLLOWED = 64


def dense_transform_keys(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor is moved by recorded motion. One of its objects has a location, rotation or scale that varies and is
    densely keyed: at least 8 keys (or samples) in its action or NLA strips, with at least one key per 4 frames between
    the first and the last. A driver or an f-curve modifier, which sets a value at every frame, counts too, and so does
    a constraint that plays a path, a track or a cache. If no solver moves the actor, the objects that it follows
    (parents, armatures, constraint targets) are checked as well, since they move it. Animation by hand has a key every
    8 to 12 frames; an exported simulation has one at every frame.
    """
    del params
    moved_by_solver = any(simulates(obj, context.scene) for obj in unit.objects)
    checked = unit.objects if moved_by_solver else (*unit.objects, *_followed(unit, context))
    dense: dict[str, Any] = {}
    for obj in checked:
        for channel in obj.channels:
            if channel.path.rpartition(".")[2].startswith(_TRANSFORMS) and is_dense(channel):
                dense[f"{obj.name}: {channel.path}"] = _channel_seen(channel)
        for constraint in obj.constraints:
            if constraint.type in _MOVING_CONSTRAINTS:
                dense[f"{obj.name}: {constraint.type}"] = list(constraint.targets[:2])
    return verdict_of(dense, dense=dict(sorted(dense.items())[:8]), solver=moved_by_solver)


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


def _followed(unit: Unit, context: AuditContext) -> Iterator[Object]:
    by_name = {obj.name: obj for obj in context.scene.objects}
    seen = set(unit.names)
    waiting = [name for obj in unit.objects for name in obj.follows]
    while waiting and len(seen) < len(unit.names) + _MOST_FOLLOWED:
        name = waiting.pop(0)
        if name in seen or name not in by_name:
            continue
        seen.add(name)
        yield by_name[name]
        waiting += by_name[name].follows


def animated_shape_keys(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor's surface is moved by stored shapes instead of a solver. One of its objects has shape keys whose values
    vary over the clip (keys, drivers, NLA), keyed vertices, or a modifier that plays a mesh from a file (mesh cache,
    Alembic or USD) and is on in the viewport or in renders. The number of keys does not matter: two are enough to
    blend one shape into another.
    """
    del context, params
    animated: dict[str, Any] = {}
    for obj in unit.objects:
        for channel in obj.shape_channels:
            if channel.varies:
                animated[f"{obj.name}: {channel.path}"] = _channel_seen(channel)
        for modifier in obj.of_type(*_GEOMETRY_CACHES):
            if modifier.show_viewport or modifier.show_render:
                animated[f"{obj.name}: {modifier.name}"] = modifier.type
    return verdict_of(animated, animated=dict(sorted(animated.items())[:8]))


def static_has_cache(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """Something in the scene is baked: the point cache of a cloth, soft body, particle system or rigid-body world is
    marked as baked, or a fluid is marked as baked or has frames on disk. A static scene has nothing to bake.
    """
    del unit, params
    baked: list[str] = []
    for obj, modifier in _solvers(context):
        caches = [part.cache for part in (modifier.cloth, modifier.soft, modifier.particles) if part]
        domain = modifier.fluid.domain if modifier.fluid else None
        if any(cache and cache.is_baked for cache in caches) or (
            domain and (domain.cache.baked or domain.cache.parts)
        ):
            baked.append(f"{obj.name}: {modifier.name}")
    world = context.scene.rigid_world
    if world is not None and world.cache.is_baked:
        baked.append("rigid-body world")
    return verdict_of(baked, baked=sorted(baked)[:8])


def static_has_rigid_world(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The scene has a rigid-body world with at least one body in it. An empty world does nothing and is allowed."""
    del unit, params
    bodies = [
        obj.name for obj in context.scene.objects if obj.rigid_body is not None and obj.rigid_body.in_world
    ]
    return verdict_of(bodies, bodies=len(bodies), some=bodies[:8])


def static_has_solver(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """An object of the scene has a modifier that simulates (cloth, soft body, fluid, particles, dynamic paint), on or
    off. Two things are allowed: hair without dynamics, which rugs and grass are made of, and collision modifiers, which
    move nothing.
    """
    del unit, params
    solvers = sorted(f"{obj.name}: {modifier.type}" for obj, modifier in _solvers(context))
    return verdict_of(solvers, solvers=solvers[:8], count=len(solvers))


def _solvers(context: AuditContext) -> Iterator[tuple[Object, Modifier]]:
    for obj in context.scene.objects:
        for modifier in obj.of_type(*SOLVERS):
            particles = modifier.particles
            if particles is None or particles.type != "HAIR" or particles.hair_dynamics:
                yield obj, modifier
