# SPDX-License-Identifier: GPL-3.0-or-later
"""Where two solids touch, and their normals there. Metres, in the world."""

import math

import numpy

from .topology import spread_numbers, topology_of

_MOST_TRIANGLES = 20_000  # of a solid that are searched for contacts
_MOST_ALONG = 3_000  # points along their edges
_MOST_TOUCHES = 600
_MOST_CROSSINGS = 250_000  # pairs of edges
_STEPS = 7
_ALONG_AXIS = 0.99  # cosine; what looks nearer an axis counts as flat
_OUTWARDS = numpy.array(
    [
        (math.cos(turn * math.pi / 16), math.sin(turn * math.pi / 16), rise)
        for turn in range(32)
        for rise in (-1, 0, 1)
    ]
)


class ContactPoints:
    """Points where two solids are near each other: ``places`` on the first, a triangle of each, ``own`` and ``other``.

    A point on an edge is listed once for every triangle at it.
    """

    def __init__(self, places, own, other):
        self.places, self.own, self.other = places, own, other

    def __len__(self):
        return len(self.places)


def contact_points(a, b, within):
    """The points where the surfaces of ``a`` and ``b`` are at most ``within`` apart."""
    parts = [
        _projected_points(a, b, within),
        _projected_points(b, a, within, swapped=True),
        _edge_contacts(a, b, within),
    ]
    return ContactPoints(*(numpy.concatenate(columns) for columns in zip(*parts, strict=True)))


def _thin_out(places, facing):
    """Numbers of some places: all if they are few, else the outermost of each way they face, and some in between.

    ``facing`` (ways × places): whether a face there looks that way. A fringe must not hide the slab that it hangs on.
    """
    if len(places) <= _MOST_TOUCHES:
        return range(len(places))
    kept = {*spread_numbers(len(places), _MOST_TOUCHES).tolist()}
    for chosen in (numpy.ones(len(places), bool), *facing):
        numbers = numpy.flatnonzero(chosen)
        if len(numbers):
            kept.update(numbers[(places[numbers] @ _OUTWARDS.T).argmax(axis=0)].tolist())
    return sorted(kept)


def _facing(topology, ats, place_of, triangle_of, count):
    """For each way along an axis and each of the places ``ats``, whether a face there looks that way."""
    normals = topology.normals[triangle_of]
    ways = []
    for axis in range(3):
        for sign in (-1, 1):
            looks = numpy.zeros(count, bool)
            looks[place_of[normals[:, axis] * sign > _ALONG_AXIS]] = True
            ways.append(looks[ats])
    return ways


def _near(solid, other, within):
    """Numbers of the triangles of a solid whose boxes come near another one's."""
    corners = solid.points[solid.triangles]
    low, high = other.low - within, other.high + within
    near = numpy.nonzero(((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)).all(axis=1))[0]
    return near[spread_numbers(len(near), _MOST_TRIANGLES)]


def _projected_points(solid, other, within, *, swapped=False):
    """Contact points of corners of ``solid``, and of places along its edges, with ``other``."""
    topology = topology_of(solid)
    near = _near(solid, other, within)
    places, place_of, triangle_of = _places(topology, near)
    low, high = other.low - within, other.high + within
    inside = numpy.nonzero(((places >= low) & (places <= high)).all(axis=1))[0]
    slack = max(1e-5, 2e-6 * float(numpy.abs(other.points).max()))
    find, around = other.tree.find_nearest, other.tree.find_nearest_range
    feet = []
    for at, place in zip(inside.tolist(), places[inside].tolist(), strict=True):
        foot = find(place, within)[0]
        if foot is not None:
            feet.append((at, foot))
    if not feet:
        return _no_points()
    at_feet = numpy.array([at for at, _ in feet])
    facing = _facing(topology, at_feet, place_of, triangle_of, len(places))
    feet = [feet[at] for at in _thin_out(numpy.array([foot for _, foot in feet]), facing)]
    # A nearest point on an edge belongs to all triangles there, not only to the one that was returned.
    hits = numpy.array([(at, index, *foot) for at, foot in feet for _, _, index, _ in around(foot, slack)])
    hits = hits[_distinct(hits[:, 0].astype(int), topology_of(other).normals[hits[:, 1].astype(int)])]
    ats, others = hits[:, 0].astype(int), hits[:, 1].astype(int)
    of_touches = numpy.isin(place_of, ats)
    place_of, triangle_of = place_of[of_touches], triangle_of[of_touches]
    chosen = _distinct(place_of, topology.normals[triangle_of])
    place_of, triangle_of = place_of[chosen], triangle_of[chosen]
    order = numpy.argsort(place_of, kind="stable")
    starts = numpy.searchsorted(place_of[order], numpy.arange(len(places) + 1))
    counts = starts[ats + 1] - starts[ats]
    rows = numpy.repeat(numpy.arange(len(ats)), counts)
    step = numpy.arange(len(rows)) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
    own = triangle_of[order[starts[ats][rows] + step]]
    if swapped:
        return hits[rows, 2:5], others[rows], own
    return places[ats][rows], own, others[rows]


def _distinct(places, normals):
    """Numbers of rows that keep each (place, rounded normal) once: hundreds of triangles may meet at a place."""
    steps = numpy.round((normals + 1) * 20).astype(numpy.int64)
    keys = ((places * 64 + steps[:, 0]) * 64 + steps[:, 1]) * 64 + steps[:, 2]
    return numpy.unique(keys, return_index=True)[1]


def edge_points_in_box(solid, other):
    """Corners of a solid, and places along its edges, that are in another one's box."""
    places = _places(topology_of(solid), _near(solid, other, 0.0))[0]
    return places[((places >= other.low) & (places <= other.high)).all(axis=1)]


def _places(topology, near):
    """(places, and in two rows: a place's number, a triangle that it is on) of some triangles of a shape."""
    corners = topology.corners[near]
    known, back = numpy.unique(corners, return_inverse=True)
    places, place_of, triangle_of = [topology.places[known]], [back.reshape(-1)], [numpy.repeat(near, 3)]
    edges, back = _edges_of(corners)
    steps = min(_STEPS, _MOST_ALONG // max(len(edges), 1))
    if steps:
        first, last = topology.places[edges[:, 0]], topology.places[edges[:, 1]]
        shares = (numpy.arange(steps) + 1) / (steps + 1)
        along = first[:, None] + shares[None, :, None] * (last - first)[:, None]
        places.append(along.reshape(-1, 3))
        numbers = len(known) + back[:, None] * steps + numpy.arange(steps)
        place_of.append(numbers.reshape(-1))
        triangle_of.append(numpy.repeat(numpy.tile(near, 3), steps))
    return numpy.concatenate(places), numpy.concatenate(place_of), numpy.concatenate(triangle_of)


def _edges_of(corners):
    """(edges, for each triangle's first, second and third side in turn the number of its edge)."""
    ends = numpy.concatenate([corners[:, (0, 1)], corners[:, (1, 2)], corners[:, (2, 0)]]).astype(numpy.int64)
    count = int(ends.max(initial=0)) + 1
    keys, back = numpy.unique(ends.min(axis=1) * count + ends.max(axis=1), return_inverse=True)
    return numpy.stack([keys // count, keys % count], axis=1), back.reshape(-1)


def _edge_contacts(a, b, within):
    """Contact points between edges that pass close to each other."""
    sides = []
    for solid, other in ((a, b), (b, a)):
        topology, near = topology_of(solid), _near(solid, other, within)
        edges, back = _edges_of(topology.corners[near])
        first, last = topology.places[edges[:, 0]], topology.places[edges[:, 1]]
        low, high = other.low - within, other.high + within
        chosen = ((numpy.minimum(first, last) <= high) & (numpy.maximum(first, last) >= low)).all(axis=1)[
            back
        ]
        sides.append((first[back][chosen], (last - first)[back][chosen], numpy.tile(near, 3)[chosen]))
    (p, d, own), (q, e, others) = sides
    if not len(p) or not len(q) or len(p) * len(q) > _MOST_CROSSINGS:
        return _no_points()
    between = p[:, None] - q[None]
    dd, ee, de = (d * d).sum(1)[:, None], (e * e).sum(1)[None], d @ e.T
    dr, er = numpy.einsum("ik,ijk->ij", d, between), numpy.einsum("jk,ijk->ij", e, between)
    square = dd * ee - de * de
    with numpy.errstate(all="ignore"):
        s, t = (de * er - dr * ee) / square, (dd * er - de * dr) / square
        cross = (square > 1e-9 * dd * ee) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    i, j = numpy.nonzero(cross)
    here, there = p[i] + s[i, j][:, None] * d[i], q[j] + t[i, j][:, None] * e[j]
    close = numpy.linalg.norm(here - there, axis=1) <= within
    return here[close], own[i][close], others[j][close]


def _no_points():
    return numpy.zeros((0, 3)), numpy.zeros(0, int), numpy.zeros(0, int)


def normals_of(a, b, contacts):
    """[(normals of a, normals of b)] at contacts, outwards: of flat faces, and smoothed as for curved surfaces.

    An open surface has no outside: its normal is taken opposite to the other one's; of two, one is taken upwards.
    """
    sides = []
    for solid, triangles in ((a, contacts.own), (b, contacts.other)):
        topology = topology_of(solid)
        sign = topology.outward[triangles][:, None]
        sides.append(
            (sign, (topology.normals[triangles], topology.smooth_normals(triangles, contacts.places)))
        )
    (sign_a, of_a), (sign_b, of_b) = sides
    pairs = []
    for normal in of_a:
        for other in of_b:
            n, m = normal * numpy.where(sign_a == 0, 1, sign_a), other * numpy.where(sign_b == 0, 1, sign_b)
            m = numpy.where((sign_a == 0) & (sign_b == 0) & (m[:, 2:] < 0), -m, m)
            against = (n * m).sum(axis=1, keepdims=True) > 0
            flip_n = against & (sign_a == 0)
            flip_m = against & (sign_b == 0) & (sign_a != 0)
            pairs.append((numpy.where(flip_n, -n, n), numpy.where(flip_m, -m, m)))
    return pairs
