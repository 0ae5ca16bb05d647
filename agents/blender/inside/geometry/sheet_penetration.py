# SPDX-License-Identifier: GPL-3.0-or-later
"""How far sheets reach through each other. Metres."""

import numpy
from mathutils import Vector

from .closed_parts import thinned
from .solids import meeting
from .topology import connected_labels
from .triangle_intersections import IntersectionLines, cross, normals_of, unit

_MOST_PAIRS = 200_000
_MOST_LINES = 1_500
_MOST_OF_PART = 500
_UPRIGHT = 0.9  # least share of a way from a sheet that is along its normal, if its foot is not at its rim


def reach_through(a, b):
    """(depth, place): how far one sheet reaches through another where they cross, by whichever way is shorter."""
    pairs = meeting(a, b, _MOST_PAIRS)
    lines = IntersectionLines(a, b, thinned(pairs, _MOST_LINES))
    if not len(lines.ours):
        return 0.0, a.points[0]
    ways = [_Side(lines, pairs[:, 0]).reach(), _Side(lines.swapped(), pairs[:, 1]).reach()]
    return min(ways, key=lambda way: way[0])


class _Side:
    """A sheet that is cut by another one: how far it reaches to either side of where they cross."""

    def __init__(self, lines, crossed):
        self._lines, self._sheet = lines, lines.other
        solid = lines.solid
        self._places, same = solid.welded
        self._corners = same[solid.triangles]
        whole = numpy.ones(len(solid.triangles), bool)
        whole[crossed] = False
        left = self._corners[whole]
        self._part = connected_labels(len(self._places), left[:, :2], left[:, 1:])
        self._reaches, self._both = {}, {}

    def reach(self):
        """(how far, a place there): of all places where they cross, that where it is most."""
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
        """Across each line, as far as its triangle goes: (places n × 2 × 3, the parts n × 2 that go on from there)."""
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
        return thinned(self._places[self._part == part], _MOST_OF_PART).tolist()

    def _reach_of(self, part):
        """How far a part is from the other sheet at most."""
        if part < 0:
            return 0.0
        if part not in self._reaches:
            self._reaches[part] = max(self._sheet.nearest(place)[3] for place in self._places_of(part))
        return self._reaches[part]

    def _reach_around(self, part):
        """Of a part that goes around the other sheet's rim: how far it is on both sides of that, beside its rim."""
        if part not in self._both:
            sides = [0.0, 0.0]
            for place in self._places_of(part):
                foot, normal, _, away = self._sheet.nearest(place)
                along = (Vector(place) - foot).dot(normal)
                if abs(along) >= _UPRIGHT * away:
                    sides[along > 0] = max(sides[along > 0], abs(along))
            self._both[part] = min(sides)
        return self._both[part]
