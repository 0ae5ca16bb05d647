# SPDX-License-Identifier: GPL-3.0-or-later
"""How deep solids penetrate each other. Metres.

The depth is that of the deepest point of one surface below the other; if the two share surfaces, the thickness of what
they share. A mesh that is open, or too thin to have an inside, is a sheet: the depth between two sheets is how far one
reaches through the other, on the shallower side. A mesh that is inside out, or has the camera in it, is hollow like a
room or a sky, and counts as a sheet.
"""

import numpy
from mathutils import Vector

from .closed_parts import TOUCH, closed_parts_of, is_inside, middle_behind, thin_out
from .sheet_penetration import sheet_depth
from .solids import crossing_pairs
from .topology import piece_labels
from .triangle_intersections import IntersectionLines, normals_of, unit

_MOST_PAIRS = 200_000
_MOST_LINES = 4_000
_MOST_PLACES = 1_500
_MOST_OF_SHEET = 500
_ALONG = numpy.array(
    (0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98)
)  # shares along the part of an edge that may be inside
_TOWARDS = (0.4, 0.7)  # shares of the way from the middle of a cut in a face to its outline
_OUTLINE = 400
_STEP = 1e-5
_MIDDLES = 10
_NORMALS = 4
_EDGES = 2
_AXES = tuple(map(Vector, ((1, 0, 0), (0, 1, 0), (0, 0, 1))))
_NUDGE, _MOST_NUDGE, _COARSE = 1e-5, 2e-4, 2e-6


def penetration(a, b, noise=0.0):
    """(depth, place, reason if it is undecided) of two solids; None if they at most touch.

    Also None if their boxes show that they cannot be deeper in each other than ``noise``.
    """
    if _coincide(a, b):
        return None, Vector(a.points[0]), "their surfaces are the same: one may be a duplicate"
    ceiling = float(numpy.minimum(a.high - b.low, b.high - a.low).min())
    if ceiling <= max(TOUCH, noise):
        return None
    a, b = (_nudged(a), b) if len(a.triangles) <= len(b.triangles) else (a, _nudged(b))
    pairs = crossing_pairs(a, b, _MOST_PAIRS)
    if not len(pairs) and not is_inside(a, b) and not is_inside(b, a):
        return None
    lines = IntersectionLines(a, b, thin_out(pairs, _MOST_LINES))
    ours, theirs = closed_parts_of(a), closed_parts_of(b)
    depth, place = _SharedVolume(a, b, lines).depth()
    if ours.sheets is not None and theirs.sheets is not None and len(pairs):
        reach = sheet_depth(ours.sheets, theirs.sheets)
        depth, place = max((depth, place), reach, key=lambda entry: entry[0])
    return min(depth, ceiling), Vector(place), ""


def _coincide(a, b):
    """Whether two sheets coincide, so that nothing of them crosses."""
    if max(numpy.abs(a.low - b.low).max(), numpy.abs(a.high - b.high).max()) > TOUCH:
        return False
    if closed_parts_of(a).core is not None or closed_parts_of(b).core is not None:
        return False
    for solid, other in ((a, b), (b, a)):
        places = thin_out(
            numpy.concatenate([solid.points, solid.points[solid.triangles].mean(axis=1)]), _MOST_OF_SHEET
        )
        if any(other.nearest(place, TOUCH)[0] is None for place in places.tolist()):
            return False
    return True


def _nudged(solid):
    """A copy moved by a tiny step: corners and edges exactly on the other solid would cross nothing."""
    if solid.nudged is None:
        step = min(max(_NUDGE, _COARSE * float(numpy.abs(solid.points).max())), _MOST_NUDGE)
        solid.nudged = solid.moved(step * numpy.array((0.7, -0.5, 0.9)))
    return solid.nudged


# Solids with an inside


class _SharedVolume:
    """The volume that two solids share, of which at least one has an inside."""

    def __init__(self, a, b, lines):
        self._cores = closed_parts_of(a).core, closed_parts_of(b).core
        self._lines = lines, lines.swapped()
        self._deepest = [
            _deepest(solid, core, lines)
            for solid, core, lines in (
                (a, self._cores[1], self._lines[0]),
                (b, self._cores[0], self._lines[1]),
            )
            if core is not None
        ]

    def depth(self):
        """(depth, place): of a point of one surface below the other, or of a point inside both."""
        lines = self._lines[0].middles
        best = 0.0, lines[0] if len(lines) else self._lines[0].solid.points[0]
        best = max([best, *((depth, place) for depth, place, _ in self._deepest)], key=lambda entry: entry[0])
        directions = self._directions_out()
        for place in () if None in self._cores else self._inner_points():
            shortest = numpy.inf
            for direction in directions:
                shortest = min(
                    shortest,
                    self._distance_out(1, place, direction) + self._distance_out(0, place, -direction),
                )
                if shortest <= best[0]:
                    break
            else:
                best = shortest, place
        return best

    def _distance_out(self, number, place, direction):
        """The distance out of a solid from a place in it or on it."""
        core = self._cores[number]
        if core is None:
            return 0.0
        start = place + direction * _STEP
        hit, normal, _, length = core.tree.ray_cast(start, direction)
        if hit is None:
            return 0.0
        inside = normal.dot(direction) > 0 if core.oriented else core.holds(start)
        return length + _STEP if inside else 0.0

    def _inner_points(self):
        """Points in the middle of one solid that are in the other one as well."""
        for ours, theirs in (self._cores, self._cores[::-1]):
            low, high = ours.boxes
            near = numpy.nonzero(((low <= theirs.high) & (high >= theirs.low)).all(axis=1))[0]
            for triangle in thin_out(near, _MIDDLES).tolist():
                place = middle_behind(ours, triangle)
                if place is not None and theirs.holds(place):
                    yield place

    def _directions_out(self):
        """Directions in which the way out may be shortest."""
        directions = [Vector(place) - foot for _, place, foot in self._deepest if foot is not None]
        sides = [_most_frequent(normals_of(lines.solid, lines.ours), _NORMALS) for lines in self._lines]
        edges = [_most_frequent(_edge_directions(lines), _EDGES) for lines in self._lines]
        directions += [Vector(normal) for normals in sides for normal in normals]
        directions += [Vector(edge).cross(Vector(other)) for edge in edges[0] for other in edges[1]]
        directions += _AXES
        directions = [direction.normalized() for direction in directions if direction.length > 1e-9]
        return [*directions, *(-direction for direction in directions)]


def _deepest(solid, core, lines):
    """(depth, place, nearest point of the core) of the point of a surface that is deepest in the core of the other."""
    inside = ((solid.points > core.low) & (solid.points < core.high)).all(axis=1)
    places = numpy.concatenate(
        [
            thin_out(solid.points[inside], _MOST_PLACES),
            thin_out(_points_on_edges(solid, lines), _MOST_PLACES),
            thin_out(_points_on_faces(solid, lines), _MOST_PLACES),
        ]
    )
    room = numpy.minimum(places - core.low, core.high - places).min(axis=1)
    best = 0.0, None, None
    for at in numpy.argsort(-room).tolist():
        if room[at] <= best[0]:
            break
        foot, _, _, away = core.nearest(places[at].tolist())
        if away is not None and away > best[0] and core.holds(places[at].tolist()):
            best = away, places[at], foot
    return best


def _edge_directions(lines):
    places, _ = lines.solid.welded
    return unit(places[lines.edges[:, 1]] - places[lines.edges[:, 0]])


def _most_frequent(vectors, most):
    """The most frequent directions of some unit vectors, regardless of sign."""
    if not len(vectors):
        return []
    level = numpy.where((vectors @ (0.577, 0.211, 0.789) < 0)[:, None], -vectors, vectors)
    _, first, counts = numpy.unique((level * 20).round() + 0.0, axis=0, return_index=True, return_counts=True)
    return level[first[numpy.argsort(-counts, kind="stable")[:most]]]


def _points_on_edges(solid, lines):
    """Points along edges, between where these go through the other surface."""
    if not len(lines.edges):
        return numpy.empty((0, 3))
    places, _ = solid.welded
    edges, back = numpy.unique(lines.edges, axis=0, return_inverse=True)
    back = back.reshape(-1)
    numbers = numpy.concatenate([back, numpy.arange(len(edges)), numpy.arange(len(edges))])
    shares = numpy.concatenate([lines.shares, numpy.zeros(len(edges)), numpy.ones(len(edges))])
    order = numpy.lexsort([shares, numbers])
    numbers, shares = numbers[order], shares[order]
    stretch = (numbers[1:] == numbers[:-1]) & (shares[1:] - shares[:-1] > 1e-9)
    first, last, edge = shares[:-1][stretch], shares[1:][stretch], edges[numbers[:-1][stretch]]
    along = first[:, None] + _ALONG * (last - first)[:, None]
    start, end = places[edge[:, 0]], places[edge[:, 1]]
    return (start[:, None] + along[..., None] * (end - start)[:, None]).reshape(-1, 3)


def _points_on_faces(solid, lines):
    """Points on faces: the middle of what goes through them, and between there and its outline."""
    if not len(lines.ours):
        return numpy.empty((0, 3))
    other, middles = lines.other, lines.middles
    corners = other.corners[lines.theirs]
    label = piece_labels(len(other.welded[0]), corners)[corners[:, 0]]
    _, group = numpy.unique(label, return_inverse=True)
    group = group.reshape(-1)
    sizes = numpy.bincount(group)
    centres = numpy.stack([numpy.bincount(group, axis) / sizes for axis in middles.T], axis=1)
    outline = thin_out(numpy.arange(len(middles)), _OUTLINE)
    middles, towards = middles[outline], centres[group[outline]]
    tried = [centres, *(towards + share * (middles - towards) for share in _TOWARDS)]
    return numpy.array([solid.nearest(place)[0] for place in numpy.concatenate(tried).tolist()]).reshape(
        -1, 3
    )
