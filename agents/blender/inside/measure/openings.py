# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how well a filler fits its opening (see agents.protocol.measures.contact)."""

import math

import numpy
from mathutils import Vector

from ..geometry.topology import topology_of

_DIRECTIONS = 96
_COARSE = 6
_PLANES = 7  # across the filler, in which the rim is searched for
_BESIDE = 0.01  # metres before and behind the filler in which the host may be if it is a sheet
_STEPS = 48
_HALVINGS = 16
_WAYS = 8


def opening(request, solids):
    """See OpeningMeasure.

    The filler is cut by planes across the axis of the opening. In each, rays go from the middle to the rim; of a host
    that is a sheet, whose rim no ray can hit, the rim is where it begins to cover what is behind it. In each direction,
    the plane with the narrowest gap counts.
    """
    filler, host = solids.joined(request["filler"]), solids.joined(request["host"])
    sections = [_Section(filler, host, direction) for direction in _candidate_axes(filler, host)]
    section = min(sections, key=lambda section: _axis_rank(section.rim(_COARSE)))
    rim, direction = section.rim(), section.direction
    if not rim:
        return {"unbounded": 360.0, "at": ((filler.low + filler.high) / 2).tolist()}
    turns = sorted(rim)
    before, after = [turns[-1] - _DIRECTIONS, *turns[:-1]], [*turns[1:], turns[0] + _DIRECTIONS]
    widest = max(b - a for a, b in zip(turns, after, strict=True))
    gaps = [
        (
            _gap(*rim[turn], [rim[neighbour % _DIRECTIONS][0] for neighbour in (last, following)], direction),  # pyright: ignore[reportCallIssue]
            rim[turn][0],
        )
        for last, turn, following in zip(before, turns, after, strict=True)
    ]
    gap, at = max(gaps, key=lambda entry: entry[0])
    return {"unbounded": 360.0 * (widest - 1) / _DIRECTIONS, "gap": gap, "at": tuple(at)}


def _axis_rank(rim):
    """A sort key: the axis straight through the opening has a rim all around, and the narrowest gap."""
    return -len(rim), max(((foot - place).length for place, foot in rim.values()), default=0.0)


def _gap(place, foot, beside, direction):
    """The width of the gap at a place of the rim, measured across it; in a corner, not along the diagonal."""
    away, least = foot - place, (foot - place).length
    for other in beside:
        along = (other - place) - (other - place).dot(direction) * direction
        if along.length > 0:
            along.normalize()
            parts = abs(away.dot(along)), abs(away.dot(direction)), abs(away.dot(direction.cross(along)))
            least = min(least, max(parts))
    return least


def _candidate_axes(filler, host):
    """Directions that an opening may have: the most frequent normals of nearby faces."""
    candidates = [numpy.eye(3)[axis] for axis in range(3)]
    around = filler.diagonal / 2
    for solid in (filler, host):
        topology = topology_of(solid)
        corners = topology.places[topology.corners]
        near = (
            (corners.min(axis=1) <= filler.high + around) & (corners.max(axis=1) >= filler.low - around)
        ).all(axis=1)
        normals = topology.normals[near]
        level = numpy.where((normals @ (0.577, 0.211, 0.789) < 0)[:, None], -normals, normals)
        kinds, back = numpy.unique(level.round(2) + 0.0, axis=0, return_inverse=True)
        weighed = level * topology.areas[near][:, None]
        sums = numpy.stack([numpy.bincount(back.reshape(-1), axis, len(kinds)) for axis in weighed.T], axis=1)
        lengths = numpy.linalg.norm(sums, axis=1)
        candidates += [
            sums[place] / lengths[place] for place in numpy.argsort(-lengths)[:_WAYS] if lengths[place] > 0
        ]
    directions = []
    for direction in candidates:
        if all(abs(direction @ other) < 0.999999 for other in directions):
            directions.append(direction)
    return directions


class _Section:
    """A filler and a host, seen along the axis of the opening."""

    def __init__(self, filler, host, direction):
        self._filler, self._host, self.direction = filler, host, Vector(direction)
        across = numpy.cross(direction, numpy.eye(3)[int(numpy.argmin(numpy.abs(direction)))])
        across /= numpy.linalg.norm(across)
        self._axes = across, numpy.cross(direction, across)
        along = filler.points @ direction
        self._low, self._high = float(along.min()), float(along.max())
        self._middle = numpy.array(
            [((spread := filler.points @ axis).min() + spread.max()) / 2 for axis in self._axes]
        )
        self._reach = 0.75 * filler.diagonal + 0.05

    def rim(self, every=1):
        """{direction: (place, the filler's nearest one)}; {} where the middle of the filler is not in an opening."""
        if self._covered(0.0, (1.0, 0.0)) is not None:
            return {}
        shares = (numpy.arange(_PLANES) + 0.5) / _PLANES
        heights = self._low + shares * (self._high - self._low)
        if self._host.closed and any(
            self._host.holds(self._place(0.0, (1.0, 0.0), height)) for height in heights
        ):
            return {}
        rim = {}
        for turn in range(0, _DIRECTIONS, every):
            angle = 2 * math.pi * turn / _DIRECTIONS
            heading = math.cos(angle), math.sin(angle)
            places = [place for height in heights if (place := self._rim_by_ray(heading, height)) is not None]
            if not places and (place := self._rim_by_coverage(heading, _STEPS // every)) is not None:
                places = [place]
            if places:
                feet = [(place, self._filler.nearest(place)[0]) for place in places]
                rim[turn] = min(feet, key=lambda pair: (pair[1] - pair[0]).length)
        return rim

    def _place(self, distance, heading, height):
        u, v = self._middle + distance * numpy.array(heading)
        return Vector(u * self._axes[0] + v * self._axes[1] + height * numpy.array(self.direction))

    def _rim_by_ray(self, heading, height):
        """Where a ray from the middle meets the host."""
        start = self._place(0.0, heading, height)
        return self._host.tree.ray_cast(start, self._place(1.0, heading, height) - start, self._reach)[0]

    def _rim_by_coverage(self, heading, steps):
        """Where the host begins to cover what is behind it."""
        last = 0.0
        for step in range(1, steps + 1):
            distance = self._reach * step / steps
            if self._covered(distance, heading) is None:
                last = distance
                continue
            free, covered = last, distance
            for _ in range(_HALVINGS):
                middle = (free + covered) / 2
                if self._covered(middle, heading) is None:
                    free = middle
                else:
                    covered = middle
            return self._covered(covered, heading)
        return None

    def _covered(self, distance, heading):
        start = self._place(distance, heading, self._low - _BESIDE)
        length = self._high - self._low + 2 * _BESIDE
        return self._host.tree.ray_cast(start, self.direction, length)[0]
