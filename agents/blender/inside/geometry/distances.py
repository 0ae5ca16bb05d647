# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances between the surfaces of solids. Metres."""

import math

import numpy
from mathutils import Vector

from .solids import crossing_pairs

_FEW = 20_000  # corners that are all tried; of more, this many
_SOME = 500  # triangles around a place
_SEEDS = 24
_ROUNDS = 60
_FIRST = 32  # corners that are tried before anything slower
_MOST_PAIRS = 4_000_000  # of edges
_CHUNK = 500_000


def gap(a, b, beyond=math.inf, enough=0.0):
    """(distance, place on a, place on b); (0, place, place) where they cross; None if they are ``beyond`` apart.

    The nearest pair is a corner and a face, or two edges. The search ends at the first distance up to ``enough``.
    """
    best = _NearestPair(beyond, enough)
    if box_distance(a, b) > beyond:
        return None
    if enough and (touch := _near_enough_pair(a, b, best)):
        return touch
    crossed = crossing_pairs(a, b, 1)
    if len(crossed):
        place = Vector(a.points[a.triangles[crossed[0, 0]]].mean(axis=0))
        place = b.nearest(a.nearest(b.nearest(place)[0])[0])[0]
        return 0.0, place, place
    _try_corners(a, b, best, swapped=False)
    _try_corners(b, a, best, swapped=True)
    if not best.is_enough:
        _try_edges(a, b, best)
    return best.pair


def box_distance(a, b):
    """The distance between the boxes of two solids."""
    return float(numpy.linalg.norm(numpy.maximum(0.0, numpy.maximum(a.low - b.high, b.low - a.high))))


def _near_enough_pair(a, b, best):
    """A pair that is near enough, if one of a few corners has one: most contacts are corners on faces."""
    other_way = a.has_tree or (not b.has_tree and len(a.triangles) < len(b.triangles))
    for swapped in (other_way, not other_way):
        solid, other = (b, a) if swapped else (a, b)
        least = _box_distances(solid.points, solid.points, other.low, other.high)
        for at in least.argpartition(_FIRST)[:_FIRST] if len(least) > _FIRST else range(len(least)):
            point = solid.points[at].tolist()
            place, _, _, distance = other.nearest(point, min(best.distance * (1 + 1e-6) + 1e-9, 1e30))
            if place is not None:
                best.offer(distance, Vector(point), place, swapped=swapped)
            if best.is_enough:
                return best.pair
    return None


class _NearestPair:
    def __init__(self, beyond, enough):
        self.distance, self._enough = beyond, enough
        self.pair = None

    @property
    def is_enough(self):
        return self.pair is not None and self.distance <= self._enough

    def offer(self, distance, here, there, *, swapped=False):
        if distance < self.distance or (self.pair is None and distance == self.distance):
            self.distance = distance
            self.pair = (distance, there, here) if swapped else (distance, here, there)


def _try_corners(solid, other, best, *, swapped):
    """Projects the corners of one onto the other, starting with those that may be nearest."""
    points = solid.points
    if len(points) > _FEW:
        points = points[:: len(points) // _FEW + 1]
    least = _box_distances(points, points, other.low, other.high)
    order = numpy.argsort(least)
    seeds = []
    for at in order.tolist():
        if least[at] > best.distance or best.is_enough:
            break
        point = points[at].tolist()
        place, _, _, distance = other.nearest(point, min(best.distance * (1 + 1e-6) + 1e-9, 1e30))
        if place is not None:
            best.offer(distance, Vector(point), place, swapped=swapped)
            seeds.append((distance, point))
    if len(points) < len(solid.points):
        for distance, point in sorted(seeds)[:_SEEDS]:
            best.offer(*_settle(Vector(point), distance, solid, other), swapped=swapped)


def _settle(point, distance, solid, other):
    """Projects a point to and fro between two solids until it settles: (distance, place on solid, place on other)."""
    here, there = point, other.nearest(point)[0]
    for _ in range(_ROUNDS):
        here_next = solid.nearest(there)[0]
        there_next = other.nearest(here_next)[0]
        shorter = (there_next - here_next).length
        here, there = here_next, there_next
        if distance - shorter < 1e-7:
            break
        distance = shorter
    return (here - there).length, here, there


def _box_distances(lows, highs, low, high):
    """The distances of boxes (n × 3) from another one."""
    return numpy.linalg.norm(numpy.maximum(0.0, numpy.maximum(low - highs, lows - high)), axis=1)


def _try_edges(a, b, best):
    """Tries the edges that may be nearer to each other than corners and faces are."""
    ours, theirs = (
        _edges_near(a, b, best, best.pair and best.pair[1]),
        _edges_near(b, a, best, best.pair and best.pair[2]),
    )
    if len(ours) * len(theirs) > _MOST_PAIRS:
        ours, theirs = (
            _nearest_edges(some, other, best.distance) for some, other in ((ours, b), (theirs, a))
        )
    if not len(ours) or not len(theirs):
        return
    rows = max(1, _CHUNK // len(theirs))
    for start in range(0, len(ours), rows):
        if best.is_enough:
            return
        _try_edge_pairs(ours[start : start + rows], theirs, best)


def _edges_near(solid, other, best, place):
    """The edges (n × 2 × 3) of triangles that may be near enough to another solid; of very many, those near a place."""
    low, high = solid.boxes
    chosen = numpy.nonzero(_box_distances(low, high, other.low, other.high) <= best.distance)[0]
    if len(chosen) > _FEW and place is not None:
        away = _box_distances(low[chosen], high[chosen], numpy.array(place), numpy.array(place))
        chosen = chosen[numpy.argpartition(away, _SOME)[:_SOME]]
    corners = solid.points[solid.triangles[chosen]]
    edges = numpy.stack([corners, corners[:, (1, 2, 0)]], axis=2).reshape(-1, 2, 3)
    return edges[_box_distances(edges.min(axis=1), edges.max(axis=1), other.low, other.high) <= best.distance]


def _nearest_edges(edges, other, distance):
    """Of too many edges, those that may be within a distance of a solid, the nearest first."""
    most = math.isqrt(_MOST_PAIRS)
    middles, halves = edges.mean(axis=1), numpy.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) / 2
    if len(edges) > _FEW:
        chosen = numpy.argsort(-halves)[:_FEW]
        edges, middles, halves = edges[chosen], middles[chosen], halves[chosen]
    ranked = []
    for at, (middle, half) in enumerate(zip(middles.tolist(), halves.tolist(), strict=True)):
        away = other.nearest(middle, distance + half)[3]
        if away is not None:
            ranked.append((away - half, at))
    ranked.sort()
    return edges[[at for _, at in ranked[:most]]]


def _try_edge_pairs(ours, theirs, best):
    """Tries the pairs of two sets of edges that are nearest to each other between their ends."""
    p, q = ours[:, 0], theirs[:, 0]
    d, e = ours[:, 1] - p, theirs[:, 1] - q
    dd, ee, de = (d * d).sum(1)[:, None], (e * e).sum(1)[None], d @ e.T
    # (p − q) · d and (p − q) · e, without a table of all the differences
    dr = (p * d).sum(1)[:, None] - d @ q.T
    er = p @ e.T - (q * e).sum(1)[None]
    with numpy.errstate(all="ignore"):
        square = dd * ee - de * de
        s, t = (de * er - dr * ee) / square, (dd * er - de * dr) / square
        between = (square > 1e-12 * dd * ee) & (s > 0) & (s < 1) & (t > 0) & (t < 1)
    i, j = numpy.nonzero(between)
    if not len(i):
        return
    here, there = p[i] + s[i, j][:, None] * d[i], q[j] + t[i, j][:, None] * e[j]
    lengths = numpy.linalg.norm(here - there, axis=1)
    at = int(lengths.argmin())
    if lengths[at] < best.distance:
        best.offer(float(lengths[at]), Vector(here[at]), Vector(there[at]))
