"""Readings that several predicates share: cache coverage, partners, motion; and their common thresholds."""

from __future__ import annotations

from math import acos, degrees, dist
from typing import TYPE_CHECKING, Any

from pydantic import Field

from bench.audit.predicates.predicate import PredicateParams

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from bench.audit.facts import Domain, Effectors, Object, PointCache, Scene, Vector
    from bench.audit.predicates.predicate import AuditContext, Unit

# Share of the clip's frames, and of a bake's. A frame missing at either end is not seen; a cache that was freed, or
# baked for another clip, holds far less.
COVERED = 0.95
# An object that moved less than a centimetre and turned less than a degree looks still.
MOVED_METRES, MOVED_DEGREES = 0.01, 1.0


class Partners(PredicateParams):
    """``partners``: names of actors; an empty list: any other object of the scene."""

    partners: tuple[str, ...] = ()


class MinCount(PredicateParams):
    """``min``: how many at least."""

    min: int = Field(default=1, ge=1)


def admits(wanted: str | tuple[str, ...] | None, found: str) -> bool:
    """Whether a value is the wanted one, or one of several; without a wanted one, any is."""
    return not wanted or found in ((wanted,) if isinstance(wanted, str) else wanted)


def number(value: float) -> float:
    """A number as it is reported: rounded to four decimals, never minus zero."""
    return round(value, 4) + 0.0


def common(first: tuple[int, int], second: tuple[int, int]) -> int:
    """How many frames two ranges share."""
    return max(0, min(first[1], second[1]) - max(first[0], second[0]) + 1)


def spans(frames: tuple[int, int], context: AuditContext, since: float | None = None) -> bool:
    """Whether a range covers the scene's frames, and the minimum length that the spec asks for.

    ``since``: the first frame at which there is anything; earlier frames need not be covered.
    """
    shared = common(frames, context.scene.range)
    before = max(0.0, since - context.scene.range[0]) if since is not None else 0.0
    return shared >= COVERED * (_wanted(context) - before)


def _wanted(context: AuditContext) -> int:
    return max(context.scene.length, context.least_frames)


def range_seen(frames: tuple[int, int], context: AuditContext) -> dict[str, Any]:
    """The range of a cache beside the frames that it is to cover, as it is reported."""
    return {
        "cache_range": list(frames),
        "clip": list(context.scene.range),
        "covers": common(frames, context.scene.range),
        "of_frames": _wanted(context),
    }


def is_filled(cache: PointCache, context: AuditContext, since: float | None = None) -> bool:
    """Whether a cache is baked, over the clip (from ``since`` on, as for spans), and holds the frames."""
    held = cache.frames >= max(1.0, COVERED * cache.expected)
    return cache.is_baked and held and spans(cache.range, context, since)


def cache_seen(cache: PointCache, context: AuditContext) -> dict[str, Any]:
    """A point cache, as it is reported."""
    return {
        "baked": cache.is_baked,
        **range_seen(cache.range, context),
        "frames": cache.frames,
        "frames_expected": cache.expected,
        "where": cache.where,
    }


def parts_of(domain: Domain) -> tuple[str, ...]:
    """The parts of its cache that a domain needs for what it shows."""
    if domain.kind == "LIQUID":
        return ("data", "mesh") if domain.use_mesh else ("data",)
    return ("data", "noise") if domain.use_noise else ("data",)


def has_files(domain: Domain, context: AuditContext) -> bool:
    """Whether all that a domain needs lies on disk, over the clip."""
    cache = domain.cache
    length = common(cache.range, context.scene.range)
    parts = [cache.part(name) for name in parts_of(domain)]
    return spans(cache.range, context) and all(part and part.frames >= COVERED * length for part in parts)


def members(scene: Scene, collection: str | None) -> frozenset[str] | None:
    """Names of the objects in a collection and in those below it; None for no collection: everything."""
    if collection is None:
        return None
    wanted, names = [collection], set[str]()
    seen = set[str]()
    while wanted:
        name = wanted.pop()
        if name in seen:
            continue
        seen.add(name)
        for item in scene.collections:
            if item.name == name:
                names.update(item.objects)
            elif item.parent == name:
                wanted.append(item.name)
    return frozenset(names)


def collides(obj: Object) -> bool:
    """Whether it has a collision modifier that is on."""
    return any(modifier.on for modifier in obj.of_type("COLLISION"))


def blows(obj: Object) -> bool:
    """Whether it is a force field whose strength is not zero, or is animated: a gust starts from zero."""
    animated = any(channel.path == "field.strength" and channel.varies for channel in obj.channels)
    return obj.force is not None and (obj.force.strength != 0 or animated)


def partners_of(
    unit: Unit, context: AuditContext, names: Iterable[str]
) -> Iterator[tuple[str, tuple[Object, ...]]]:
    """Each partner's name with its objects; without partners, ``"anything"`` with all objects but the unit's."""
    partners = tuple(names)
    for name in partners:
        yield name, context.named(name)
    if not partners:
        yield "anything", tuple(obj for obj in context.scene.objects if obj.name not in unit.names)


def colliding_partners(
    unit: Unit, context: AuditContext, names: tuple[str, ...], effectors: Iterable[Effectors]
) -> dict[str, list[str]]:
    """Partner → its objects that collide with one of the simulations whose ``effectors`` are given (up to 8 each)."""
    colliding: dict[str, list[str]] = {}
    for each in effectors:
        within = members(context.scene, each.collisions)
        for name, objects in partners_of(unit, context, names):
            hits = [obj.name for obj in objects if collides(obj) and (within is None or obj.name in within)]
            colliding.setdefault(name, []).extend(hits[:8])
    return colliding


def travel(obj: Object) -> tuple[float, float] | None:
    """How far its corners or origin moved (metres), and how far it turned (degrees), since the start.

    At the middle or at the end, whichever is more; None if its motion was not played.
    """
    if len(obj.moments) < 2:
        return None
    first = obj.moments[0]
    metres = turned = 0.0
    for moment in obj.moments[1:]:
        metres = max(metres, dist(first.location, moment.location))
        for before, after in ((first.low, moment.low), (first.high, moment.high)):
            if before is not None and after is not None:
                metres = max(metres, dist(before, after))
        cosine = abs(sum(a * b for a, b in zip(first.rotation, moment.rotation, strict=True)))
        turned = max(turned, degrees(2 * acos(min(1.0, cosine))))
    return metres, turned


def moved(obj: Object) -> bool:
    """Whether it visibly moved or turned."""
    distances = travel(obj)
    return distances is not None and (distances[0] >= MOVED_METRES or distances[1] >= MOVED_DEGREES)


def reaches(domain: Domain, obj: Object) -> bool:
    """Whether an object's bounds overlap the domain's box at the start, middle or end."""
    boxes = ((moment.low, moment.high) for moment in obj.moments)
    return any(low and high and _meet(domain.low, domain.high, low, high) for low, high in boxes)


def _meet(low: Vector, high: Vector, other_low: Vector, other_high: Vector) -> bool:
    below = all(a <= b for a, b in zip(low, other_high, strict=True))
    return below and all(a <= b for a, b in zip(other_low, high, strict=True))
