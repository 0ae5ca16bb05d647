"""Soft bodies: the modifier, the cache, the goal, collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.audit.predicates.predicate import Verdict, judged
from bench.audit.predicates.shared_readings import cache_seen, collides, is_filled, members, partners_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Object, SoftBody
    from bench.audit.predicates.predicate import Params, Stage, Unit
    from bench.audit.predicates.shared_readings import Partners


def _softs(unit: Unit) -> Iterator[tuple[Object, SoftBody]]:
    for one, modifier in unit.modifiers("SOFT_BODY"):
        if modifier.soft is not None:
            yield one, modifier.soft


def soft_modifier(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor is simulated as a soft body: one of its objects has a SOFT_BODY modifier, on or off (see
    solver_enabled).
    """
    del stage, params
    found = [one.name for one, _ in _softs(unit)]
    return judged(found, soft=found[:8])


def soft_cache_baked(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The soft body's motion is baked: its point cache is marked as baked, its range covers 95 % of the scene's frames
    and of the clip's minimum length, and it holds 95 % of the frames of its own range, as for cloth.
    """
    del params
    found = [soft.cache for _, soft in _softs(unit)]
    filled = [cache for cache in found if is_filled(cache, stage)]
    return judged(filled, caches=[cache_seen(cache, stage) for cache in found][:4])


def soft_collision_partners(unit: Unit, stage: Stage, params: Partners) -> Verdict:
    """The soft body collides with its partners: each partner (if none is named: at least one other object) has an
    object with a COLLISION modifier that is on and, if the soft body has a collision collection, is in it. A soft body
    falls through anything without this modifier.
    """
    seen: dict[str, list[str]] = {}
    for _, soft in _softs(unit):
        within = members(stage.scene, soft.effectors.collisions)
        for name, objects in partners_of(unit, stage, params.partners):
            found = [one.name for one in objects if collides(one) and (within is None or one.name in within)]
            seen.setdefault(name, []).extend(found[:8])
    return judged(seen and all(seen.values()), carry_collision=seen)


def soft_goal_group(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """Part of the soft body is held in place: its goal is on, and the goal's vertex group is set, exists, and has at
    least one vertex with a weight above zero. With the goal off, none of it is held; without a group, all of it is.
    """
    del stage, params
    groups = [
        {
            "goal": soft.use_goal,
            "group": soft.goal_group,
            "weighted": next(
                (each.weighted for each in one.vertex_groups if each.name == soft.goal_group), 0
            ),
        }
        for one, soft in _softs(unit)
    ]
    return judged(any(each["goal"] and each["weighted"] for each in groups), groups=groups[:8])


def soft_rigid_partners(unit: Unit, stage: Stage, params: Partners) -> Verdict:
    """The soft body's rigid partners take part in both simulations: each partner (if none is named: at least one other
    object) has an object that is a rigid body of the scene's world and has a COLLISION modifier that is on. The two
    solvers ignore each other: the rigid-body world moves the object, the modifier lets it press on the soft body. An
    actor without a soft body fails.
    """
    if not any(True for _ in _softs(unit)):
        return judged(False, soft=[])
    seen = {
        name: [
            one.name
            for one in objects
            if one.rigid_body is not None and one.rigid_body.in_world and collides(one)
        ][:8]
        for name, objects in partners_of(unit, stage, params.partners)
    }
    return judged(seen and all(seen.values()), rigid_and_collision=seen)
