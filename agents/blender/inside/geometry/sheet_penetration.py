# SPDX-License-Identifier: GPL-3.0-or-later
"""How deep sheets, which have no inside, penetrate each other. Metres."""

import numpy
from mathutils import Vector

from .closed_parts import thin_out
from .solids import crossing_pairs
from .topology import piece_labels
from .triangle_intersections import IntersectionLines, cross, normals_of, unit

_MOST_PAIRS = 200_000
_MOST_LINES = 1_500
_MOST_OF_PART = 500
_UPRIGHT = 0.9  # least cosine to the normal at the nearest point of a sheet, unless that is on its rim


def sheet_depth(a, b):
    """(depth, place): how far one sheet reaches through another where they cross, on the shallower side."""
    pairs = crossing_pairs(a, b, _MOST_PAIRS)
    lines = IntersectionLines(a, b, thin_out(pairs, _MOST_LINES))
    if not len(lines.ours):
        return 0.0, a.points[0]
    ways = [_Side(lines, pairs[:, 0]).reach(), _Side(lines.swapped(), pairs[:, 1]).reach()]
    return min(ways, key=lambda way: way[0])


class _Side:
    """A sheet that another one cuts: how far it reaches to either side of the cut."""

    def __init__(self, lines, crossed):
        self._lines, self._sheet = lines, lines.other
        solid = lines.solid
        self._places, self._corners = solid.welded[0], solid.corners
        whole = numpy.ones(len(solid.triangles), bool)
        whole[crossed] = False
        self._part = piece_labels(len(self._places), self._corners[whole])
        self._reaches, self._both = {}, {}

    def reach(self):
        """(depth, place) where it is deepest."""
        ends, parts = self._ends()
        best = 0.0, self._lines.middles[0]
        for places, (ahead, behind) in zip(ends.tolist(), parts.tolist(), strict=True):
            lengths = [self._sheet.nearest(place)[3] or 0.0 for place in places]
            if ahead != behind:
                lengths = [
                    max(length, self._reach_of(part))
                    for length, part in zip(lengths, (ahead, behind), strict=True)
                ]
                least = min(lengths)
            else:
                least = max(min(lengths), self._reach_around(ahead))
            if least > best[0]:
                best = least, places[lengths.index(min(lengths))]
        return best

    def _ends(self):
        """Across each cut to the triangle's border: (places n × 2 × 3, connected parts n × 2 behind them)."""
        lines, places = self._lines, self._places
        corners = places[self._corners[lines.ours]]
        normals = normals_of(lines.solid, lines.ours)
        others = normals_of(lines.other, lines.theirs)
        along = unit(lines.ends[:, 1] - lines.ends[:, 0])
        short = ~along.any(axis=1)
        along[short] = unit(cross(normals, others))[short]
        way = cross(normals, along)
        way *= numpy.where((way * others).sum(axis=1) < 0, -1, 1)[:, None]
        middles = lines.middles
        sides = corners[:, (1, 2, 0)] - corners
        outwards = cross(sides, normals[:, None])
        room = numpy.maximum(0.0, numpy.einsum("ijk,ijk->ij", corners - middles[:, None], outwards))
        slope = numpy.einsum("ik,ijk->ij", way, outwards)
        with numpy.errstate(all="ignore"):
            ahead = numpy.where(slope > 0, room / slope, numpy.inf).min(axis=1)
            behind = numpy.where(slope < 0, room / -slope, numpy.inf).min(axis=1)
        lengths = numpy.stack([ahead, -behind], axis=1)
        lengths[~numpy.isfinite(lengths)] = 0.0
        ends = middles[:, None] + lengths[..., None] * way[:, None]
        heights = numpy.einsum("ijk,ik->ij", corners - middles[:, None], others)
        rows = numpy.arange(len(heights))
        parts = self._part[self._corners[lines.ours]]
        top, bottom = heights.argmax(axis=1), heights.argmin(axis=1)
        joined = numpy.stack(
            [
                numpy.where(heights[rows, top] > 0, parts[rows, top], -1),
                numpy.where(heights[rows, bottom] < 0, parts[rows, bottom], -2),
            ],
            axis=1,
        )
        return ends, joined

    def _places_of(self, part):
        return thin_out(self._places[self._part == part], _MOST_OF_PART).tolist()

    def _reach_of(self, part):
        """The largest distance of a part from the other sheet."""
        if part < 0:
            return 0.0
        if part not in self._reaches:
            self._reaches[part] = max(self._sheet.nearest(place)[3] for place in self._places_of(part))
        return self._reaches[part]

    def _reach_around(self, part):
        """Of a part that goes around the other sheet's rim: how far it reaches on both of its sides."""
        if part not in self._both:
            sides = [0.0, 0.0]
            for place in self._places_of(part):
                foot, normal, _, away = self._sheet.nearest(place)
                along = (Vector(place) - foot).dot(normal)
                if abs(along) >= _UPRIGHT * away:
                    sides[along > 0] = max(sides[along > 0], abs(along))
            self._both[part] = min(sides)
        return self._both[part]
