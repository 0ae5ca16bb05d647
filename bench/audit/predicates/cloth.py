"""Cloth: its modifier, its cache, its collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.audit.predicates.predicate import PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import cache_seen, colliding_partners, is_filled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Cloth, Object
    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit
    from bench.audit.predicates.shared_readings import Partners


def _cloths(unit: Unit) -> Iterator[tuple[Object, Cloth]]:
    for obj, modifier in unit.modifiers("CLOTH"):
        if modifier.cloth is not None:
            yield obj, modifier.cloth


def cloth_modifier(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor is simulated as cloth: one of its objects has a CLOTH modifier, on or off (see solver_enabled)."""
    del context, params
    names = [obj.name for obj, _ in _cloths(unit)]
    return verdict_of(names, cloth=names[:8])


def cloth_cache_baked(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The cloth's motion is baked: its point cache is marked as baked, its range covers 95 % of the scene's frames and
    of the clip's minimum length, and it holds 95 % of the frames of its own range. Only a bake plays the same wherever
    it is rendered. The frames are counted because a cache can be marked as baked while it is empty.
    """
    del params
    caches = [cloth.cache for _, cloth in _cloths(unit)]
    filled = [cache for cache in caches if is_filled(cache, context)]
    return verdict_of(filled, caches=[cache_seen(cache, context) for cache in caches][:4])


def cloth_self_collision(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The cloth collides with itself: self-collision is on in its collision settings. Without it, folds pass through
    each other.
    """
    del context, params
    switches = [cloth.use_self_collision for _, cloth in _cloths(unit)]
    return verdict_of(any(switches), self_collision=switches[:8])


def cloth_pin_group(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The cloth is pinned: its pin group is set, exists on the object, and has at least one vertex with a weight above
    zero. A name alone pins nothing.
    """
    del context, params
    groups = [
        {"group": cloth.pin_group, "weighted": _weighted(obj, cloth.pin_group)}
        for obj, cloth in _cloths(unit)
    ]
    return verdict_of(any(group["weighted"] for group in groups), groups=groups[:8])


def _weighted(obj: Object, name: str) -> int:
    return next((group.weighted for group in obj.vertex_groups if group.name == name), 0)


def cloth_collision_partners(unit: Unit, context: AuditContext, params: Partners) -> PredicateVerdict:
    """The cloth collides with its partners: each partner (if none is named: at least one other object) has an object
    with a COLLISION modifier that is on and, if the cloth has a collision collection, is in it; and the cloth's own
    object collisions are on. Cloth passes through anything without this modifier.
    """
    effectors = [cloth.effectors for _, cloth in _cloths(unit) if cloth.use_collision]
    seen = colliding_partners(unit, context, params.partners, effectors)
    return verdict_of(seen and all(seen.values()), carry_collision=seen, object_collisions=bool(seen))
