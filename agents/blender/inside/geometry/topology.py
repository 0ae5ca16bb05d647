# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of a solid as connected triangles: neighbours, connected pieces, normals, volumes."""

import functools

import numpy

_SMOOTH = 0.5  # faces at an edge are of one curved surface up to an angle with this cosine
_TINY = 1e-15


class SurfaceTopology:
    """The triangles of a solid with their neighbours. Equal points count as one.

    ``corners`` are the places of each triangle's corners in ``places``, ``normals`` unit vectors (zero where a
    triangle has no area). ``outward``: 1 where such a normal points out of the closed piece that the triangle
    belongs to, -1 where it points into it, 0 where the piece is open and has no inside.
    """

    def __init__(self, solid):
        self.places, _ = solid.welded
        self.corners = solid.corners
        a, b, c = (self.places[self.corners[:, corner]] for corner in range(3))
        across = numpy.cross(b - a, c - a)
        doubled = numpy.linalg.norm(across, axis=1)
        self.areas = doubled / 2
        self.normals = across / numpy.maximum(doubled, _TINY)[:, None]

    @functools.cached_property
    def outward(self):
        """See the class."""
        pieces, volumes, _ = self.volumes()
        return numpy.sign(volumes)[pieces]

    def volumes(self):
        """(the piece of each triangle; by piece: signed volume, its first moments); 0 for a piece that is open."""
        count = len(self.places)
        piece_of = piece_labels(count, self.corners)
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

    @functools.cached_property
    def neighbours(self):
        """Pairs of triangles with an edge in common: two rows of their numbers."""
        keys, triangles = self._sides()
        order = numpy.argsort(keys, kind="stable")
        alike = keys[order][1:] == keys[order][:-1]
        return triangles[order][:-1][alike], triangles[order][1:][alike]

    def face_mask(self, triangle, normal, within):
        """Mask of the triangles of the face that a triangle belongs to, as seen along ``normal``.

        Those connected to it without a sharp edge, and those in its plane, with a tolerance of ``within``.
        """
        ahead = self.normals @ self.normals[triangle]
        a, b = self.neighbours
        smooth = numpy.einsum("ij,ij->i", self.normals[a], self.normals[b]) > 0.866
        patch = connected_labels(len(self.corners), a[smooth], b[smooth])
        flat = numpy.abs(
            (self.places[self.corners].mean(axis=1) - self.places[self.corners[triangle, 0]])
            @ self.normals[triangle]
        )
        level = (ahead > 0.9994) & (flat <= within)
        return ((patch == patch[triangle]) | level) & (numpy.abs(self.normals @ normal) > 0.3)

    def smooth_normals(self, triangles, places):
        """Smoothed normals at places on triangles; sharp edges stay sharp."""
        order, starts = self._incident
        vertices = self.corners[triangles].reshape(-1)
        counts = starts[vertices + 1] - starts[vertices]
        rows = numpy.repeat(numpy.arange(len(vertices)), counts)
        within = numpy.arange(len(rows)) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
        slots = order[starts[vertices][rows] + within]
        others = self.normals[slots // 3]
        weights = self._corner_angles[slots] * (
            numpy.einsum("ij,ij->i", others, self.normals[triangles][rows // 3]) > _SMOOTH
        )
        sums = [numpy.bincount(rows, weights * axis, len(vertices)) for axis in others.T]
        normals = unit(numpy.stack(sums, axis=1)).reshape(-1, 3, 3)
        return unit(numpy.einsum("ij,ijk->ik", self._barycentric(triangles, places), normals))

    @functools.cached_property
    def _incident(self):
        """(slots of ``corners`` ordered by place, for each place where its slots start)."""
        flat = self.corners.reshape(-1)
        order = numpy.argsort(flat, kind="stable")
        return order, numpy.searchsorted(flat[order], numpy.arange(len(self.places) + 1))

    @functools.cached_property
    def _corner_angles(self):
        angles = []
        for corner in range(3):
            here = self.places[self.corners[:, corner]]
            edge, other = (unit(self.places[self.corners[:, (corner + step) % 3]] - here) for step in (1, 2))
            angles.append(numpy.arccos(numpy.clip(numpy.einsum("ij,ij->i", edge, other), -1, 1)))
        return numpy.stack(angles, axis=1).reshape(-1)

    def _barycentric(self, triangles, places):
        """Barycentric coordinates of places on triangles."""
        a, b, c = (self.places[self.corners[triangles, corner]] for corner in range(3))
        opposite = [numpy.cross(c - b, places - b), numpy.cross(a - c, places - c)]
        doubled = numpy.maximum(2 * self.areas[triangles], _TINY)
        u, v = (numpy.einsum("ij,ij->i", normal, self.normals[triangles]) / doubled for normal in opposite)
        shares = numpy.clip(numpy.stack([u, v, 1 - u - v], axis=1), 0, 1)
        return shares / numpy.maximum(shares.sum(axis=1), _TINY)[:, None]


def topology_of(solid):
    """The topology of a solid; cached."""
    if solid.topology is None:
        solid.topology = SurfaceTopology(solid)
    return solid.topology


def connected_labels(count, a, b):
    """Labels for numbers 0 … ``count`` - 1: those that pairs (a, b) connect have the same, the least of them."""
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


def unit(vectors):
    """Vectors (n × 3) of length 1; zero vectors stay zero."""
    return vectors / numpy.maximum(numpy.linalg.norm(vectors, axis=1), _TINY)[:, None]


def piece_labels(count, corners):
    """Labels for ``count`` places: those that triangles (n × 3, numbers of places) connect have the same."""
    return connected_labels(count, corners[:, :2], corners[:, 1:])


def grouped(labels, boxes):
    """(numbers in the order of their labels, where each label's begin, low corners of its boxes, high corners)."""
    order = numpy.argsort(labels, kind="stable")
    starts = numpy.flatnonzero(numpy.diff(labels[order], prepend=-1))
    low, high = boxes
    return (
        order,
        starts,
        numpy.minimum.reduceat(low[order], starts),
        numpy.maximum.reduceat(high[order], starts),
    )


def spread_numbers(count, most):
    """Numbers below ``count``: all, or about ``most``, spread evenly but not at a regular step, as meshes have rows."""
    if count <= most:
        return numpy.arange(count)
    return numpy.unique((numpy.arange(most) * 0.6180339887498949 % 1 * count).astype(int))
