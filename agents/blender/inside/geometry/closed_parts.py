# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a solid has an inside, and what has none."""

import numpy
from mathutils import Vector

from .topology import connected_labels

TOUCH = 2e-5  # metres; what is no deeper only touches
_THIN = 0.002  # an inside that is no wider is none: no place in it is deeper than noise
_MOST_PIECES = 2_000
_SLACK = 3e-4  # metres; what is tested may stand a hair's breadth beside where it is


def thinned(rows, most):
    """Some rows, evenly chosen, of more."""
    return rows[:: len(rows) // most + 1] if len(rows) > most else rows


class _ClosedParts:
    """What of a solid has an inside (``core``) and what has none (``sheets``): solids, or None."""

    def __init__(self, solid):
        mask = _in_closed_parts(solid)
        if mask.all():
            core, sheets = solid, None
        elif not mask.any():
            core, sheets = None, solid
        else:
            core, sheets = solid.part(mask), solid.part(~mask)
        if core is not None and core.hollow:
            core, sheets = None, solid
        self.core, self.sheets = core, sheets


def closed_parts_of(solid):
    """See _ClosedParts; made once."""
    if solid.closed_parts is None:
        solid.closed_parts = _ClosedParts(solid)
    return solid.closed_parts


def _in_closed_parts(solid):
    """Which triangles belong to a piece that is closed and not thin."""
    places, same = solid.welded
    corners = same[solid.triangles]
    a, b, c = (places[corners[:, corner]] for corner in range(3))
    across = numpy.cross(b - a, c - a)
    areas = numpy.linalg.norm(across, axis=1) / 2
    volumes = numpy.einsum("ij,ij->i", a - places.mean(axis=0), across) / 6
    if solid.closed and solid.oriented and 2 * abs(volumes.sum()) >= _THIN * areas.sum():
        return numpy.ones(len(corners), bool)
    label = connected_labels(len(places), corners[:, :2], corners[:, 1:])
    known, pieces = numpy.unique(label[corners[:, 0]], return_inverse=True)
    pieces, count = pieces.reshape(-1), len(known)
    edges, sides = solid.edges
    is_open = numpy.zeros(len(places), bool)
    is_open[label[edges[sides % 2 == 1][:, 0]]] = True
    if solid.oriented:
        held = numpy.abs(numpy.bincount(pieces, volumes, count))
    else:  # its triangles do not tell in from out: as much as fits
        low, high = numpy.full((count, 3), numpy.inf), numpy.full((count, 3), -numpy.inf)
        for corner in (a, b, c):
            numpy.minimum.at(low, pieces, corner)
            numpy.maximum.at(high, pieces, corner)
        held = (high - low).prod(axis=1)
    is_thick = 2 * held >= _THIN * numpy.bincount(pieces, areas, count)
    return (~is_open[known] & is_thick)[pieces]


def is_in(solid, other):
    """Whether a piece of one, of which nothing crosses the other, is inside of it."""
    first, low, high = _pieces_of(solid)
    first = first[((low >= other.low - _SLACK) & (high <= other.high + _SLACK)).all(axis=1)]
    if not len(first) or closed_parts_of(other).core is None:
        return False
    core = closed_parts_of(other).core
    for triangle in thinned(first, _MOST_PIECES).tolist():
        for place in (solid.points[solid.triangles[triangle]].mean(axis=0), middle_behind(solid, triangle)):
            if place is not None and core.nearest(place)[3] > TOUCH and core.holds(place):
                return True
    return False


def _pieces_of(solid):
    """(a triangle of each piece that hangs together, the low and high corners of the boxes around them); made once."""
    if solid.pieces is None:
        places, same = solid.welded
        corners = same[solid.triangles]
        label = connected_labels(len(places), corners[:, :2], corners[:, 1:])[corners[:, 0]]
        order = numpy.argsort(label, kind="stable")
        starts = numpy.flatnonzero(numpy.diff(label[order], prepend=-1))
        low, high = solid.boxes
        solid.pieces = (
            order[starts],
            numpy.minimum.reduceat(low[order], starts),
            numpy.maximum.reduceat(high[order], starts),
        )
    return solid.pieces


def middle_behind(solid, triangle):
    """The middle of what of a closed solid is behind a triangle; None for an open one."""
    core = closed_parts_of(solid).core
    if core is None:
        return None
    a, b, c = solid.points[solid.triangles[triangle]]
    normal = Vector(b - a).cross(Vector(c - a)).normalized()
    start = Vector((a + b + c) / 3)
    for way in (-normal, normal):
        hit = core.tree.ray_cast(start + way * TOUCH, way)[0]
        if hit is not None and core.holds(middle := (start + hit) / 2):
            return middle
    return None
