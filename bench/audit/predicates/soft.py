"""Soft bodies: the modifier, the cache, the goal, collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.audit.predicates.predicate import PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import (
    cache_seen,
    collides,
    colliding_partners,
    is_filled,
    partners_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Object, SoftBody
    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit
    from bench.audit.predicates.shared_readings import Partners


def _softs(unit: Unit) -> Iterator[tuple[Object, SoftBody]]:
    for obj, modifier in unit.modifiers("SOFT_BODY"):
        if modifier.soft is not None:
            yield obj, modifier.soft


def soft_modifier(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor is simulated as a soft body: one of its objects has a SOFT_BODY modifier, on or off (see
    solver_enabled).
    """
    del context, params
    names = [obj.name for obj, _ in _softs(unit)]
    return verdict_of(names, soft=names[:8])


def soft_cache_baked(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The soft body's motion is baked: its point cache is marked as baked, its range covers 95 % of the scene's frames
    and of the clip's minimum length, and it holds 95 % of the frames of its own range, as for cloth.
    """
    del params
    caches = [soft.cache for _, soft in _softs(unit)]
    filled = [cache for cache in caches if is_filled(cache, context)]
    return verdict_of(filled, caches=[cache_seen(cache, context) for cache in caches][:4])


def soft_collision_partners(unit: Unit, context: AuditContext, params: Partners) -> PredicateVerdict:
    """The soft body collides with its partners: each partner (if none is named: at least one other object) has an
    object with a COLLISION modifier that is on and, if the soft body has a collision collection, is in it. A soft body
    falls through anything without this modifier.
    """
    effectors = [soft.effectors for _, soft in _softs(unit)]
    seen = colliding_partners(unit, context, params.partners, effectors)
    return verdict_of(seen and all(seen.values()), carry_collision=seen)


def soft_goal_group(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """Part of the soft body is held in place: its goal is on, and the goal's vertex group is set, exists, and has at
    least one vertex with a weight above zero. With the goal off, none of it is held; without a group, all of it is.
    """
    del context, params
    groups = [
        {
            "goal": soft.use_goal,
            "group": soft.goal_group,
            "weighted": next(
                (group.weighted for group in obj.vertex_groups if group.name == soft.goal_group), 0
            ),
        }
        for obj, soft in _softs(unit)
    ]
    return verdict_of(any(group["goal"] and group["weighted"] for group in groups), groups=groups[:8])


def soft_rigid_partners(unit: Unit, context: AuditContext, params: Partners) -> PredicateVerdict:
    """The soft body's rigid partners take part in both simulations: each partner (if none is named: at least one other
    object) has an object that is a rigid body of the scene's world and has a COLLISION modifier that is on. The two
    solvers ignore each other: the rigid-body world moves the object, the modifier lets it press on the soft body. An
    actor without a soft body fails.
    """
    if not any(True for _ in _softs(unit)):
        return verdict_of(False, soft=[])
    seen = {
        name: [
            obj.name
            for obj in objects
            if obj.rigid_body is not None and obj.rigid_body.in_world and collides(obj)
        ][:8]
        for name, objects in partners_of(unit, context, params.partners)
    }
    return verdict_of(seen and all(seen.values()), rigid_and_collision=seen)
