"""Cloth: its modifier, its cache, its collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.audit.predicates.predicate import Verdict, judged
from bench.audit.predicates.shared_readings import cache_seen, collides, is_filled, members, partners_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Cloth, Object
    from bench.audit.predicates.predicate import Params, Stage, Unit
    from bench.audit.predicates.shared_readings import Partners


def _cloths(unit: Unit) -> Iterator[tuple[Object, Cloth]]:
    for one, modifier in unit.modifiers("CLOTH"):
        if modifier.cloth is not None:
            yield one, modifier.cloth


def cloth_modifier(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor is simulated as cloth: one of its objects has a CLOTH modifier, on or off (see solver_enabled)."""
    del stage, params
    found = [one.name for one, _ in _cloths(unit)]
    return judged(found, cloth=found[:8])


def cloth_cache_baked(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The cloth's motion is baked: its point cache is marked as baked, its range covers 95 % of the scene's frames and
    of the clip's minimum length, and it holds 95 % of the frames of its own range. Only a bake plays the same wherever
    it is rendered. The frames are counted because a cache can be marked as baked while it is empty.
    """
    del params
    found = [cloth.cache for _, cloth in _cloths(unit)]
    filled = [cache for cache in found if is_filled(cache, stage)]
    return judged(filled, caches=[cache_seen(cache, stage) for cache in found][:4])


def cloth_self_collision(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The cloth collides with itself: self-collision is on in its collision settings. Without it, folds pass through
    each other.
    """
    del stage, params
    found = [cloth.use_self_collision for _, cloth in _cloths(unit)]
    return judged(any(found), self_collision=found[:8])


def cloth_pin_group(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The cloth is pinned: its pin group is set, exists on the object, and has at least one vertex with a weight above
    zero. A name alone pins nothing.
    """
    del stage, params
    groups = [
        {"group": cloth.pin_group, "weighted": _weighted(one, cloth.pin_group)}
        for one, cloth in _cloths(unit)
    ]
    return judged(any(group["weighted"] for group in groups), groups=groups[:8])


def _weighted(one: Object, name: str) -> int:
    return next((group.weighted for group in one.vertex_groups if group.name == name), 0)


def cloth_collision_partners(unit: Unit, stage: Stage, params: Partners) -> Verdict:
    """The cloth collides with its partners: each partner (if none is named: at least one other object) has an object
    with a COLLISION modifier that is on and, if the cloth has a collision collection, is in it; and the cloth's own
    object collisions are on. Cloth passes through anything without this modifier.
    """
    seen: dict[str, list[str]] = {}
    for _, cloth in _cloths(unit):
        if not cloth.use_collision:
            continue
        within = members(stage.scene, cloth.effectors.collisions)
        for name, objects in partners_of(unit, stage, params.partners):
            found = [one.name for one in objects if collides(one) and (within is None or one.name in within)]
            seen.setdefault(name, []).extend(found[:8])
    return judged(seen and all(seen.values()), carry_collision=seen, object_collisions=bool(seen))
