# SPDX-License-Identifier: GPL-3.0-or-later
"""The closed parts of a solid, which have an inside, and its sheets, which have none."""

import numpy
from mathutils import Vector

from .topology import grouped, piece_labels

TOUCH = 2e-5  # metres; what is no deeper counts as touching
_THIN = 0.002  # metres; a part that is no thicker counts as a sheet
_MOST_PIECES = 2_000
_SLACK = 3e-4  # metres; a tested solid may have been moved a little (see _nudged)


def thin_out(rows, most):
    """At most about ``most`` rows, evenly chosen."""
    return rows[:: len(rows) // most + 1] if len(rows) > most else rows


class _ClosedParts:
    """The parts of a solid that have an inside (``core``) and those that have none (``sheets``): solids, or None."""

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
    """The _ClosedParts of a solid; cached."""
    if solid.closed_parts is None:
        solid.closed_parts = _ClosedParts(solid)
    return solid.closed_parts


def _in_closed_parts(solid):
    """A mask of the triangles of pieces that are closed and not thin."""
    places, corners = solid.welded[0], solid.corners
    a, b, c = (places[corners[:, corner]] for corner in range(3))
    across = numpy.cross(b - a, c - a)
    areas = numpy.linalg.norm(across, axis=1) / 2
    volumes = numpy.einsum("ij,ij->i", a - places.mean(axis=0), across) / 6
    if solid.closed and solid.oriented and 2 * abs(volumes.sum()) >= _THIN * areas.sum():
        return numpy.ones(len(corners), bool)
    label = piece_labels(len(places), corners)
    known, pieces = numpy.unique(label[corners[:, 0]], return_inverse=True)
    pieces, count = pieces.reshape(-1), len(known)
    edges, sides = solid.edges
    is_open = numpy.zeros(len(places), bool)
    is_open[label[edges[sides % 2 == 1][:, 0]]] = True
    if solid.oriented:
        held = numpy.abs(numpy.bincount(pieces, volumes, count))
    else:  # without consistent normals: the volume of its box
        low, high = numpy.full((count, 3), numpy.inf), numpy.full((count, 3), -numpy.inf)
        for corner in (a, b, c):
            numpy.minimum.at(low, pieces, corner)
            numpy.maximum.at(high, pieces, corner)
        held = (high - low).prod(axis=1)
    is_thick = 2 * held >= _THIN * numpy.bincount(pieces, areas, count)
    return (~is_open[known] & is_thick)[pieces]


def is_inside(solid, other):
    """Whether a piece of ``solid``, whose surfaces do not cross, is inside the other."""
    first, low, high = _pieces_of(solid)
    first = first[((low >= other.low - _SLACK) & (high <= other.high + _SLACK)).all(axis=1)]
    if not len(first) or closed_parts_of(other).core is None:
        return False
    core = closed_parts_of(other).core
    for triangle in thin_out(first, _MOST_PIECES).tolist():
        for place in (solid.points[solid.triangles[triangle]].mean(axis=0), middle_behind(solid, triangle)):
            if place is not None and core.nearest(place)[3] > TOUCH and core.holds(place):
                return True
    return False


def _pieces_of(solid):
    """(a triangle of each connected piece, low corners of the pieces' boxes, high corners); cached."""
    if solid.pieces is None:
        label = piece_labels(len(solid.welded[0]), solid.corners)[solid.corners[:, 0]]
        order, starts, low, high = grouped(label, solid.boxes)
        solid.pieces = order[starts], low, high
    return solid.pieces


def middle_behind(solid, triangle):
    """The middle of the material of a closed solid behind a triangle; None for an open one."""
    core = closed_parts_of(solid).core
    if core is None:
        return None
    a, b, c = solid.points[solid.triangles[triangle]]
    normal = Vector(b - a).cross(Vector(c - a)).normalized()
    start = Vector((a + b + c) / 3)
    for direction in (-normal, normal):
        hit = core.tree.ray_cast(start + direction * TOUCH, direction)[0]
        if hit is not None and core.holds(middle := (start + hit) / 2):
            return middle
    return None
