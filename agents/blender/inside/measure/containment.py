# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what is in a container or sunk into something (see agents.protocol.measures.contact)."""

import math

import numpy
from mathutils import Vector

from ..geometry.contact_points import edge_points_in_box
from ..geometry.solids import Unmeasurable
from ..geometry.topology import spread_numbers, topology_of, unit

_SAMPLES = 256
_PAIRS = 64
_BAR_SAMPLES = 1500  # points on a cage's bars
_SEEN_THROUGH = 0.6  # a wall counts as perforated if it hides a smaller share than this
_SUNK = 5000  # points from which the way out is measured
_WAYS = 12
_STEEP = 0.3
_STEP = 1e-5


def _directions():
    """Directions all around, each with its opposite ``_PAIRS`` places later."""
    heights = (numpy.arange(_PAIRS) + 0.5) / _PAIRS
    turns = numpy.arange(_PAIRS) * math.pi * (3 - math.sqrt(5))
    across = numpy.sqrt(1 - heights**2)
    half = numpy.stack([across * numpy.cos(turns), across * numpy.sin(turns), heights], axis=1)
    return numpy.concatenate([half, -half])


_AROUND = _directions()
_COARSE = _AROUND.astype(numpy.float32)
_RAYS_AROUND = [Vector(direction) for direction in _AROUND]


def enclosure(request, solids):
    """The shares of a content's samples that are in a container's cavity, and in its walls.

    A point is in the cavity if at least half of all directions from it hit the container. That is so everywhere below
    the plane of a flat rim and nowhere above it, which closes an open container at its rim. Whether a point is in the
    material of a closed container follows from its winding number; a closed container without a hollow (a tank that is
    a plain box) holds its content in its volume.
    """
    content, container = solids.joined(request["content"]), solids.joined(request["container"])
    places, normals = _samples(content, _SAMPLES)
    step = max(_STEP, min(request["noise"], 0.25 * float((content.high - content.low).min())))
    cavity = _Cavity(
        container, [solids[name] for name in request["container"]], max(_STEP, request["noise"] - step)
    )
    # Samples are moved inwards a little, so that contact with a wall does not count; for a sheet, to either side.
    sides = (-1,) if content.closed else (-1, 1)
    readings = [cavity.look(places + side * step * normals) for side in sides]
    inside = max(
        (numpy.logical_or.reduce(reading) for reading in zip(*readings, strict=True)), key=numpy.mean
    )
    in_wall = numpy.logical_and.reduce([cavity.in_wall(places + side * step * normals) for side in sides])
    answer = {"inside": float(inside.mean()), "wall": float((in_wall & ~inside).mean())}
    if not inside.all():
        answer["at"] = places[int(numpy.argmin(inside))].tolist()
    return answer


class _Cavity:
    """The space in a container: its hollow, within its bars, or, if it has neither, its volume."""

    def __init__(self, whole, parts, noise):
        self._whole, self._noise = whole, noise
        self._parts = [part for part in parts if part.closed]
        self._bars = None

    def in_wall(self, places):
        """Which points are in its material, deeper than noise."""
        return self._depths(places) > self._noise

    def look(self, places):
        """Which points are in it, taken as a volume, as a vessel, and as a cage."""
        depths = self._depths(places)
        free = _within_reach(self._whole, places, self._noise) & (depths <= self._noise)
        vessel = free.copy()
        vessel[free] = [self._is_enclosed(place) for place in places[free].tolist()]
        cage = vessel.copy()
        if not vessel.all() and free.any() and self._is_perforated(places[free].mean(axis=0)):
            cage[free] = [self._directions_with_surface(place) >= _PAIRS for place in places[free]]
        return depths > 0, vessel, cage

    def _depths(self, places):
        return numpy.array([self._depth(place) for place in places.tolist()])

    def _depth(self, place):
        depth = 0.0
        for part in self._parts:
            if (part.low <= place).all() and (part.high >= place).all() and part.holds(place):
                depth = max(depth, part.nearest(place)[3] or 0.0)
        return depth

    def _is_enclosed(self, place):
        """Whether at least half of all directions hit the container."""
        hit = miss = 0
        cast, start = self._whole.tree.ray_cast, Vector(place)
        for direction in _RAYS_AROUND:
            if cast(start, direction)[0] is None:
                miss += 1
            else:
                hit += 1
            if hit >= _PAIRS or miss > _PAIRS:
                break
        return hit >= _PAIRS

    def _is_perforated(self, place):
        """Whether it surrounds a point with gaps to see through: a basket, a cage."""
        start = Vector(place)
        hit = sum(self._whole.tree.ray_cast(start, direction)[0] is not None for direction in _RAYS_AROUND)
        return hit < _SEEN_THROUGH * self._directions_with_surface(place)

    def _directions_with_surface(self, place):
        """In how many directions around a point there is a part of its surface."""
        if self._bars is None:
            self._bars = _samples(self._whole, _BAR_SAMPLES)[0].astype(numpy.float32)
        away = self._bars - place.astype(numpy.float32)
        return len(numpy.unique((unit(away) @ _COARSE.T).argmax(axis=1)))


def _samples(solid, count):
    """(points spread evenly over a surface, outward normals there)."""
    topology = topology_of(solid)
    # The same surface has the same samples, whatever the order of its triangles and corners.
    corners = numpy.sort(topology.corners, axis=1)
    order = numpy.lexsort(topology.places[corners].mean(axis=1).T)
    whole = numpy.cumsum(topology.areas[order])
    if not whole[-1] > 0:
        raise Unmeasurable(f"{solid.name!r} has faces without an area")
    wanted = (numpy.arange(count) + 0.5) / count * whole[-1]
    triangles = order[numpy.minimum(numpy.searchsorted(whole, wanted), len(whole) - 1)]
    steps = numpy.arange(count)
    root, share = numpy.sqrt((steps * 0.754877666 + 0.5) % 1), (steps * 0.569840290 + 0.5) % 1
    a, b, c = (topology.places[corners[triangles, corner]] for corner in range(3))
    weights = (1 - root)[:, None], (root * (1 - share))[:, None], (root * share)[:, None]
    places = weights[0] * a + weights[1] * b + weights[2] * c
    outward = topology.outward[triangles][:, None]
    return places, topology.normals[triangles] * numpy.where(outward == 0, 1, outward)


def _within_reach(solid, places, slack):
    """Which points are inside the convex hull of a solid, roughly."""
    topology = topology_of(solid)
    largest = numpy.argsort(topology.areas)[-_PAIRS:]
    directions = numpy.concatenate(
        [numpy.eye(3), -numpy.eye(3), topology.normals[largest], -topology.normals[largest], _AROUND]
    )
    reach = numpy.full(len(directions), -numpy.inf)
    for start in range(0, len(topology.places), 20_000):
        reach = numpy.maximum(reach, (topology.places[start : start + 20_000] @ directions.T).max(axis=0))
    return (places @ directions.T <= reach + slack).all(axis=1)


def embedding(request, solids):
    """How far a part must move to be out of its host, in the best direction."""
    part, host = solids.joined(request["part"]), solids.joined(request["host"])
    pairs = host.tree.overlap(part.tree)
    topology = topology_of(host)
    if host.closed:
        sunk = [place for place in edge_points_in_box(part, host).tolist() if host.holds(place)]
        touched = [pair[0] for pair in pairs] or [host.nearest(place)[2] for place in sunk]
        directions = (
            _most_common(topology.normals[touched] * topology.outward[touched][:, None]) if touched else []
        )
    else:
        sunk = part.points[spread_numbers(len(part.points), _SUNK)].tolist()
        directions = _directions_out_of_sheet(topology.normals[[pair[0] for pair in pairs]]) if pairs else []
    best = None
    for direction in directions:
        deepest = max(
            (
                (distance, place)
                for place in sunk
                if (distance := _way_out(host, place, direction)) is not None
            ),
            default=(0.0, None),
        )
        if best is None or deepest[0] < best[0]:
            best = deepest
    if best is None or best[1] is None:
        return {"depth": 0.0}
    return {"depth": max(0.0, best[0]), "at": best[1]}


def _most_common(normals):
    kinds, counts = numpy.unique(normals.round(1) + 0.0, axis=0, return_counts=True)
    chosen = kinds[numpy.argsort(-counts)[:_WAYS]]
    means = [normals.mean(axis=0)] if len(normals) else []
    for kind in chosen:
        means.append(normals[(numpy.abs(normals - kind) <= 0.06).all(axis=1)].mean(axis=0))
    return [mean / numpy.linalg.norm(mean) for mean in means if numpy.linalg.norm(mean) > _STEEP]


def _directions_out_of_sheet(normals):
    """Directions out of a sheet: up if it is level, to either side if it is upright."""
    level = numpy.where(normals[:, 2:] < 0, -normals, normals)
    direction = level.mean(axis=0)
    direction = direction / max(float(numpy.linalg.norm(direction)), 1e-9)
    return [direction] if direction[2] > _STEEP else [direction, -direction]


def _way_out(host, place, direction):
    return host.tree.ray_cast(Vector(place), Vector(direction))[3]
