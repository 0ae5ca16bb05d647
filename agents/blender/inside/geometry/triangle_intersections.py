# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines along which triangles of two solids intersect."""

import copy

import numpy

_SLACK = 1e-7
_FLAT = 1e-12
_TURNS = (1, 2, 0)


class IntersectionLines:
    """The lines along which triangles of ``solid`` and ``other`` intersect, a row for each.

    ``ours`` and ``theirs`` are the numbers of the triangles, ``ends`` the two ends of the line (n × 2 × 3). ``edges``
    and ``shares`` tell where edges of ``solid`` go through triangles of ``other``: the edge as a pair of its places,
    and how far along it.
    """

    def __init__(self, solid, other, pairs):
        self.solid, self.other = solid, other
        mine, others = (
            solid.points[solid.triangles[pairs[:, side]]] for side, solid in enumerate((solid, other))
        )
        shares, places, hit = _side_hits(mine, others)
        shares_back, places_back, hit_back = _side_hits(others, mine)
        there = numpy.concatenate([places, places_back], axis=1)
        valid = numpy.concatenate([hit, hit_back], axis=1)
        along = cross(_normals(mine), _normals(others))
        where = numpy.einsum("ijk,ik->ij", there, along)
        rows = numpy.arange(len(pairs))
        first = numpy.where(valid, where, numpy.inf).argmin(axis=1)
        last = numpy.where(valid, where, -numpy.inf).argmax(axis=1)
        kept = valid.any(axis=1)
        self.ours, self.theirs = pairs[kept, 0], pairs[kept, 1]
        self.ends = numpy.stack([there[rows, first], there[rows, last]], axis=1)[kept]
        self._pierced = (pairs, shares, hit), (pairs[:, ::-1], shares_back, hit_back)
        self._find_pierced_edges(*self._pierced[0])

    def _find_pierced_edges(self, pairs, shares, hit):
        row, side = numpy.nonzero(hit)
        corners = self.solid.corners[pairs[row, 0]]
        at = numpy.arange(len(row))
        first, last = corners[at, side], corners[at, numpy.array(_TURNS)[side]]
        turned = first > last
        self.edges = numpy.stack([numpy.minimum(first, last), numpy.maximum(first, last)], axis=1)
        self.shares = numpy.where(turned, 1 - shares[row, side], shares[row, side])

    @property
    def middles(self):
        """The middle of each line."""
        return self.ends.mean(axis=1)

    def swapped(self):
        """The same lines, the other way round."""
        swapped = copy.copy(self)
        swapped.solid, swapped.other = self.other, self.solid
        swapped.ours, swapped.theirs = self.theirs, self.ours
        swapped._pierced = self._pierced[::-1]
        swapped._find_pierced_edges(*swapped._pierced[0])
        return swapped


def _side_hits(corners, others):
    """(share along the side, place, whether it hits) of each side (n × 3) of triangles against others, row by row."""
    sides = corners[:, _TURNS] - corners
    base = others[:, None, 0]
    u, v = others[:, 1] - others[:, 0], others[:, 2] - others[:, 0]
    normals = cross(u, v)
    slopes = numpy.einsum("ijk,ik->ij", sides, normals)
    heights = numpy.einsum("ijk,ik->ij", base - corners, normals)
    steep = (
        numpy.abs(slopes)
        > _FLAT * numpy.linalg.norm(sides, axis=2) * numpy.linalg.norm(normals, axis=1)[:, None]
    )
    with numpy.errstate(all="ignore"):
        shares = numpy.where(steep, heights / slopes, -1.0)
        places = corners + shares[..., None] * sides
        away = places - base
        square = numpy.maximum(numpy.einsum("ij,ij->i", normals, normals), 1e-300)[:, None]
        s = numpy.einsum("ijk,ijk->ij", cross(away, v[:, None]), normals[:, None]) / square
        t = numpy.einsum("ijk,ijk->ij", cross(u[:, None], away), normals[:, None]) / square
    hit = (
        steep
        & (shares >= -_SLACK)
        & (shares <= 1 + _SLACK)
        & (s >= -_SLACK)
        & (t >= -_SLACK)
        & (s + t <= 1 + _SLACK)
    )
    return numpy.clip(shares, 0, 1), places, hit


def _normals(corners):
    return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def cross(a, b):
    """The cross products of vectors (… × 3), for few vectors several times faster than numpy's own."""
    a, b = numpy.broadcast_arrays(a, b)
    product = numpy.empty(a.shape)
    for axis in range(3):
        next_axis, last_axis = (axis + 1) % 3, (axis + 2) % 3
        product[..., axis] = a[..., next_axis] * b[..., last_axis] - a[..., last_axis] * b[..., next_axis]
    return product


def normals_of(solid, triangles):
    """The unit normals of some of its triangles; zeros for those without an area."""
    return unit(_normals(solid.points[solid.triangles[triangles]]))


def unit(vectors):
    """Unit vectors; zero vectors stay zero."""
    return vectors / numpy.maximum(numpy.linalg.norm(vectors, axis=-1), 1e-30)[..., None]
