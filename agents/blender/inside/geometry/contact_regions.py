# SPDX-License-Identifier: GPL-3.0-or-later
"""Where two solids touch, and how their surfaces are turned to each other there. Metres, in the world."""

import math

import numpy

_MOST_TRIANGLES = 20_000  # of a solid that are looked at for where it touches
_MOST_ALONG = 3_000  # places along their edges
_MOST_TOUCHES = 600
_MOST_CROSSINGS = 250_000  # pairs of edges
_SMOOTH = 0.5  # faces at an edge are of one curved surface up to an angle with this cosine
_STEPS = 7
_TINY = 1e-15
_OUTWARDS = numpy.array(
    [
        (math.cos(turn * math.pi / 16), math.sin(turn * math.pi / 16), rise)
        for turn in range(32)
        for rise in (-1, 0, 1)
    ]
)


class Shape:
    """What the triangles of a solid are to each other. Equal points count as one.

    ``corners`` are the places of each triangle's corners in ``places``, ``normals`` unit vectors (zero where a
    triangle has no area). ``outward``: 1 where such a normal leads out of the closed piece that the triangle belongs
    to, -1 where it leads into it, 0 where the piece is open and has no inside.
    """

    def __init__(self, solid):
        self.solid = solid
        self.places, same = solid.welded
        self.corners = same[solid.triangles]
        a, b, c = (self.places[self.corners[:, corner]] for corner in range(3))
        across = numpy.cross(b - a, c - a)
        doubled = numpy.linalg.norm(across, axis=1)
        self.areas = doubled / 2
        self.normals = across / numpy.maximum(doubled, _TINY)[:, None]
        self._incident = self._angles = self._pairs = self._outward = None

    @property
    def outward(self):
        """See the class."""
        if self._outward is None:
            pieces, volumes, _ = self.volumes()
            self._outward = numpy.sign(volumes)[pieces]
        return self._outward

    def volumes(self):
        """(the piece of each triangle; by piece: signed volume, its first moments); 0 for a piece that is open."""
        count = len(self.places)
        piece_of = labels(count, self.corners[:, :2], self.corners[:, 1:])
        pieces = piece_of[self.corners[:, 0]]
        keys, counts = numpy.unique(self._sides()[0], return_counts=True)
        is_open = numpy.zeros(count, bool)
        is_open[piece_of[keys[counts % 2 == 1] // count]] = True
        middle = self.places.mean(axis=0)
        a, b, c = (self.places[self.corners[:, corner]] - middle for corner in range(3))
        each = numpy.einsum("ij,ij->i", a, numpy.cross(b, c)) / 6
        whole = numpy.bincount(pieces, each, count)
        flat = numpy.abs(whole) <= 1e-6 * numpy.bincount(pieces, self.areas, count) ** 1.5
        moments = numpy.stack([numpy.bincount(pieces, each * sums, count) for sums in ((a + b + c) / 4).T])
        keep = ~(is_open | flat)
        return pieces, whole * keep, (moments + middle[:, None] * whole) * keep

    def _sides(self):
        """(keys, triangles) of all sides of triangles; those of one edge have the same key."""
        pairs = numpy.sort(
            numpy.concatenate([self.corners[:, (0, 1)], self.corners[:, (1, 2)], self.corners[:, (2, 0)]]),
            axis=1,
        )
        real = pairs[:, 0] != pairs[:, 1]
        triangles = numpy.tile(numpy.arange(len(self.corners)), 3)
        return (pairs[:, 0].astype(numpy.int64) * len(self.places) + pairs[:, 1])[real], triangles[real]

    def neighbours(self):
        """Pairs of triangles with an edge in common: two rows of their numbers."""
        if self._pairs is None:
            keys, triangles = self._sides()
            order = numpy.argsort(keys, kind="stable")
            alike = keys[order][1:] == keys[order][:-1]
            self._pairs = triangles[order][:-1][alike], triangles[order][1:][alike]
        return self._pairs

    def face(self, triangle, normal, within):
        """Mask of the triangles of the face that a triangle belongs to, as seen along ``normal``.

        Those that it runs on to without a sharp edge, and those in one plane with it, up to ``within`` beside it.
        """
        ahead = self.normals @ self.normals[triangle]
        a, b = self.neighbours()
        smooth = numpy.einsum("ij,ij->i", self.normals[a], self.normals[b]) > 0.866
        found = labels(len(self.corners), a[smooth], b[smooth])
        flat = numpy.abs(
            (self.places[self.corners].mean(axis=1) - self.places[self.corners[triangle, 0]])
            @ self.normals[triangle]
        )
        level = (ahead > 0.9994) & (flat <= within)
        return ((found == found[triangle]) | level) & (numpy.abs(self.normals @ normal) > 0.3)

    def smooth(self, triangles, places):
        """Normals of the curved surface at places on triangles, where their edges are no sharp ones."""
        if self._incident is None:
            flat = self.corners.reshape(-1)
            order = numpy.argsort(flat, kind="stable")
            starts = numpy.searchsorted(flat[order], numpy.arange(len(self.places) + 1))
            self._incident = order, starts
            self._angles = self._corner_angles().reshape(-1)
        order, starts = self._incident
        vertices = self.corners[triangles].reshape(-1)
        counts = starts[vertices + 1] - starts[vertices]
        rows = numpy.repeat(numpy.arange(len(vertices)), counts)
        within = numpy.arange(len(rows)) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
        slots = order[starts[vertices][rows] + within]
        others = self.normals[slots // 3]
        weights = self._angles[slots] * (
            numpy.einsum("ij,ij->i", others, self.normals[triangles][rows // 3]) > _SMOOTH
        )
        sums = [numpy.bincount(rows, weights * axis, len(vertices)) for axis in others.T]
        normals = _unit(numpy.stack(sums, axis=1)).reshape(-1, 3, 3)
        return _unit(numpy.einsum("ij,ijk->ik", self._shares(triangles, places), normals))

    def _corner_angles(self):
        angles = []
        for corner in range(3):
            here = self.places[self.corners[:, corner]]
            one, other = (_unit(self.places[self.corners[:, (corner + step) % 3]] - here) for step in (1, 2))
            angles.append(numpy.arccos(numpy.clip(numpy.einsum("ij,ij->i", one, other), -1, 1)))
        return numpy.stack(angles, axis=1)

    def _shares(self, triangles, places):
        """Barycentric coordinates of places on triangles."""
        a, b, c = (self.places[self.corners[triangles, corner]] for corner in range(3))
        opposite = [numpy.cross(c - b, places - b), numpy.cross(a - c, places - c)]
        doubled = numpy.maximum(2 * self.areas[triangles], _TINY)
        u, v = (numpy.einsum("ij,ij->i", one, self.normals[triangles]) / doubled for one in opposite)
        shares = numpy.clip(numpy.stack([u, v, 1 - u - v], axis=1), 0, 1)
        return shares / numpy.maximum(shares.sum(axis=1), _TINY)[:, None]


def shape_of(solid):
    """The shape of a solid, made once."""
    if solid.shape is None:
        solid.shape = Shape(solid)
    return solid.shape


def labels(count, a, b):
    """Numbers 0 … ``count`` - 1 with those that pairs (a, b) join labelled alike: by the least of them."""
    a, b = numpy.asarray(a).reshape(-1), numpy.asarray(b).reshape(-1)
    label = numpy.arange(count)
    while True:
        before = label
        least = numpy.minimum(label[a], label[b])
        label = label.copy()
        for ends in (before[a], before[b], a, b):
            numpy.minimum.at(label, ends, least)
        while not numpy.array_equal(deeper := label[label], label):
            label = deeper
        if numpy.array_equal(label, before):
            return label


def _unit(vectors):
    return vectors / numpy.maximum(numpy.linalg.norm(vectors, axis=1), _TINY)[:, None]


class Touches:
    """Places where two solids are near each other: ``places`` on the first, ``apart``, and a triangle of each.

    A place on an edge is there once for every triangle at it.
    """

    def __init__(self, places, apart, own, other):
        self.places, self.apart, self.own, self.other = places, apart, own, other

    def __len__(self):
        return len(self.places)


def touches(a, b, within):
    """Where the surfaces of ``a`` and ``b`` are at most ``within`` apart."""
    found = [_dropped(a, b, within), _dropped(b, a, within, swapped=True), _crossed(a, b, within)]
    return Touches(*(numpy.concatenate(columns) for columns in zip(*found, strict=True)))


def _thinned(places):
    """Numbers of some places: all of a few; of many the outermost, and as many as will do in between."""
    if len(places) <= _MOST_TOUCHES:
        return range(len(places))
    outermost = numpy.unique((places @ _OUTWARDS.T).argmax(axis=0))
    return sorted({*outermost.tolist(), *some(len(places), _MOST_TOUCHES).tolist()})


def some(count, most):
    """Numbers below ``count``: all, or ``most`` of them. Evenly spread, but in no step that rows of a mesh may have."""
    if count <= most:
        return numpy.arange(count)
    return numpy.unique((numpy.arange(most) * 0.6180339887498949 % 1 * count).astype(int))


def _near(solid, other, within):
    """Numbers of the triangles of a solid whose boxes come near another one's."""
    corners = solid.points[solid.triangles]
    low, high = other.low - within, other.high + within
    near = numpy.nonzero(((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)).all(axis=1))[0]
    return near[some(len(near), _MOST_TRIANGLES)]


def _dropped(one, other, within, *, swapped=False):
    """Touches of corners of ``one``, and of places along its edges, with ``other``."""
    shape = shape_of(one)
    near = _near(one, other, within)
    places, place_of, triangle_of = _places(shape, near)
    low, high = other.low - within, other.high + within
    inside = numpy.nonzero(((places >= low) & (places <= high)).all(axis=1))[0]
    slack = max(1e-5, 2e-6 * float(numpy.abs(other.points).max()))
    find, around = other.tree.find_nearest, other.tree.find_nearest_range
    found = []
    for at, place in zip(inside.tolist(), places[inside].tolist(), strict=True):
        foot, _, _, apart = find(place, within)
        if foot is not None:
            found.append((at, apart, foot))
    if not found:
        return _none()
    found = [found[at] for at in _thinned(numpy.array([foot for _, _, foot in found]))]
    # A foot on an edge belongs to all triangles there, whichever of them was found first.
    hits = numpy.array(
        [(at, apart, index, *foot) for at, apart, foot in found for _, _, index, _ in around(foot, slack)]
    )
    hits = hits[_distinct(hits[:, 0].astype(int), shape_of(other).normals[hits[:, 2].astype(int)])]
    ats, others = hits[:, 0].astype(int), hits[:, 2].astype(int)
    of_touches = numpy.isin(place_of, ats)
    place_of, triangle_of = place_of[of_touches], triangle_of[of_touches]
    chosen = _distinct(place_of, shape.normals[triangle_of])
    place_of, triangle_of = place_of[chosen], triangle_of[chosen]
    order = numpy.argsort(place_of, kind="stable")
    starts = numpy.searchsorted(place_of[order], numpy.arange(len(places) + 1))
    counts = starts[ats + 1] - starts[ats]
    rows = numpy.repeat(numpy.arange(len(ats)), counts)
    step = numpy.arange(len(rows)) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
    own = triangle_of[order[starts[ats][rows] + step]]
    if swapped:
        return hits[rows, 3:6], hits[rows, 1], others[rows], own
    return places[ats][rows], hits[rows, 1], own, others[rows]


def _distinct(places, normals):
    """Numbers of rows such that each place has every normal, roughly, once: hundreds of triangles may meet at it."""
    steps = numpy.round((normals + 1) * 20).astype(numpy.int64)
    keys = ((places * 64 + steps[:, 0]) * 64 + steps[:, 1]) * 64 + steps[:, 2]
    return numpy.unique(keys, return_index=True)[1]


def corners_and_edges(solid, other):
    """Corners of a solid, and places along its edges, that are in another one's box."""
    places = _places(shape_of(solid), _near(solid, other, 0.0))[0]
    return places[((places >= other.low) & (places <= other.high)).all(axis=1)]


def _places(shape, near):
    """(places, and in two rows: a place's number, a triangle that it is on) of some triangles of a shape."""
    corners = shape.corners[near]
    known, back = numpy.unique(corners, return_inverse=True)
    places, place_of, triangle_of = [shape.places[known]], [back.reshape(-1)], [numpy.repeat(near, 3)]
    edges, back = _edges_of(corners)
    steps = min(_STEPS, _MOST_ALONG // max(len(edges), 1))
    if steps:
        first, last = shape.places[edges[:, 0]], shape.places[edges[:, 1]]
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


def _crossed(a, b, within):
    """Touches between edges that cross each other in passing."""
    sides = []
    for one, other in ((a, b), (b, a)):
        shape, near = shape_of(one), _near(one, other, within)
        edges, back = _edges_of(shape.corners[near])
        first, last = shape.places[edges[:, 0]], shape.places[edges[:, 1]]
        low, high = other.low - within, other.high + within
        chosen = ((numpy.minimum(first, last) <= high) & (numpy.maximum(first, last) >= low)).all(axis=1)[
            back
        ]
        sides.append((first[back][chosen], (last - first)[back][chosen], numpy.tile(near, 3)[chosen]))
    (p, d, own), (q, e, others) = sides
    if not len(p) or not len(q) or len(p) * len(q) > _MOST_CROSSINGS:
        return _none()
    between = p[:, None] - q[None]
    dd, ee, de = (d * d).sum(1)[:, None], (e * e).sum(1)[None], d @ e.T
    dr, er = numpy.einsum("ik,ijk->ij", d, between), numpy.einsum("jk,ijk->ij", e, between)
    square = dd * ee - de * de
    with numpy.errstate(all="ignore"):
        s, t = (de * er - dr * ee) / square, (dd * er - de * dr) / square
        cross = (square > 1e-9 * dd * ee) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    i, j = numpy.nonzero(cross)
    here, there = p[i] + s[i, j][:, None] * d[i], q[j] + t[i, j][:, None] * e[j]
    apart = numpy.linalg.norm(here - there, axis=1)
    close = apart <= within
    return here[close], apart[close], own[i][close], others[j][close]


def _none():
    return numpy.zeros((0, 3)), numpy.zeros(0), numpy.zeros(0, int), numpy.zeros(0, int)


def normals_of(a, b, found):
    """[(normals of a, normals of b)] at touches, leading outwards: for flat faces, and as the surfaces are curved.

    An open surface has no outside: its normal is taken against the other one's; between two, the lower is below.
    """
    sides = []
    for solid, triangles in ((a, found.own), (b, found.other)):
        shape = shape_of(solid)
        sign = shape.outward[triangles][:, None]
        sides.append((sign, (shape.normals[triangles], shape.smooth(triangles, found.places))))
    (sign_a, of_a), (sign_b, of_b) = sides
    pairs = []
    for one in of_a:
        for other in of_b:
            n, m = one * numpy.where(sign_a == 0, 1, sign_a), other * numpy.where(sign_b == 0, 1, sign_b)
            m = numpy.where((sign_a == 0) & (sign_b == 0) & (m[:, 2:] < 0), -m, m)
            against = (n * m).sum(axis=1, keepdims=True) > 0
            flip_n = against & (sign_a == 0)
            flip_m = against & (sign_b == 0) & (sign_a != 0)
            pairs.append((numpy.where(flip_n, -n, n), numpy.where(flip_m, -m, m)))
    return pairs
