# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertical lines through two surfaces: where each is on them, as solid or sheet, and which is over the other."""

import numpy

_SAME = 1e-5  # metres
_SLIVER = 1e-14  # square metres, twice a triangle's area in plan
_MOST_TRIED = 4_000_000  # pairs of a line and a triangle per batch
GRID = 10


class Columns:
    """Lines at ``places`` (n, 2), and per line the stretches [(low, high), …] of surfaces ``a`` and ``b``.

    Stretches are sorted; that of a sheet is a single height.
    """

    def __init__(self, first, second, near_first, near_second):
        """``near_…`` (k, 3): points on either surface through which to draw lines."""
        low = numpy.maximum(first.low[:2], second.low[:2]) - _SAME
        high = numpy.minimum(first.high[:2], second.high[:2]) + _SAME
        kept_first, kept_second = (_within(points, low, high) for points in (near_first, near_second))
        grid = _grid(low, high) if (low <= high).all() else numpy.empty((0, 2))
        self.places = numpy.concatenate([kept_first[:, :2], kept_second[:, :2], grid])
        known_first = dict(enumerate(kept_first[:, 2].tolist()))
        known_second = dict(enumerate(kept_second[:, 2].tolist(), len(kept_first)))
        self.a = _stretches(first, self.places, known_first)
        self.b = _stretches(second, self.places, known_second)


def _within(points, low, high):
    return points[((points[:, :2] >= low) & (points[:, :2] <= high)).all(axis=1)]


def _grid(low, high):
    """Places in a rectangle, at uneven positions so that they avoid grid-aligned edges."""
    steps = (numpy.arange(GRID) + 0.4637) / GRID
    x, y = numpy.meshgrid(
        low[0] + steps * (high[0] - low[0]), low[1] + (1 - steps * 0.9973) * (high[1] - low[1])
    )
    return numpy.stack([x.ravel(), y.ravel()], axis=1)


def _stretches(surface, places, known):
    lines, heights, turns = _hits(surface, places)
    order = numpy.lexsort((-turns, heights, lines))
    per_line = [[] for _ in places]
    for line, height, turn in zip(
        lines[order].tolist(), heights[order].tolist(), turns[order].tolist(), strict=True
    ):
        per_line[line].append((height, turn))
    stretches = [_stretched(hits) for hits in per_line]
    for line, height in known.items():
        if not any(low - _SAME <= height <= high + _SAME for low, high in stretches[line]):
            stretches[line] = sorted([*stretches[line], (height, height)])
    return stretches


def _stretched(hits):
    """Stretches of one line's hits, from below: heights with 1 where a solid begins, -1 where it ends, 0 on a sheet."""
    if sum(turn for _, turn in hits):  # the line runs along an edge: inside and outside are undecided
        return sorted({(height, height) for height, _ in hits})
    stretches, depth, begun = [], 0, 0.0
    for height, turn in hits:
        if turn > 0 and depth == 0:
            begun = height
        depth += turn
        if turn < 0 and depth == 0:
            stretches.append((begun, height))
        if turn == 0:
            stretches.append((height, height))
    return sorted(stretches)


def _hits(surface, places):
    """(line, height, turn) of every hit of a vertical line with a triangle."""
    hits = [(numpy.empty(0, dtype=int), numpy.empty(0), numpy.empty(0, dtype=int))]
    if len(places) and len(surface.faces):
        order = numpy.argsort(places[:, 0], kind="stable")
        x, y = places[order, 0], places[order, 1]
        for which, at in _tried(surface, x, y):
            lines, heights, turns = _crossed(surface, which, x[at], y[at])
            hits.append((order[at[lines]], heights, turns))
    return [numpy.concatenate(each) for each in zip(*hits, strict=True)]


def _tried(surface, x, y):
    """Triangles and lines (indices of both) that may meet, in batches; ``x`` is sorted."""
    least, greatest = surface.boxes
    begin = numpy.searchsorted(x, least[:, 0])
    counts = numpy.searchsorted(x, greatest[:, 0], side="right") - begin
    counts[(least[:, 1] > y.max()) | (greatest[:, 1] < y.min())] = 0
    near = numpy.flatnonzero(counts)
    begin, counts = begin[near], counts[near]
    reached = numpy.cumsum(counts)
    start = 0
    while start < len(near):
        before = reached[start - 1] if start else 0
        stop = max(start + 1, int(numpy.searchsorted(reached, before + _MOST_TRIED, side="right")))
        own = counts[start:stop]
        which = numpy.repeat(near[start:stop], own)
        at = numpy.arange(len(which)) + numpy.repeat(begin[start:stop] - numpy.cumsum(own) + own, own)
        level = (least[which, 1] <= y[at]) & (y[at] <= greatest[which, 1])
        yield which[level], at[level]
        start = stop


def _crossed(surface, which, x, y):
    """(indices of the pairs that meet, heights, turns)."""
    first, second, third = (corners[which] for corners in surface.triangles)
    one, two = second - first, third - first
    across = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    dx, dy = x - first[:, 0], y - first[:, 1]
    with numpy.errstate(divide="ignore", invalid="ignore", over="ignore"):
        u = (dx * two[:, 1] - dy * two[:, 0]) / across
        v = (one[:, 0] * dy - one[:, 1] * dx) / across
        hit = (numpy.abs(across) > _SLIVER) & (u >= 0) & (v >= 0) & (u + v <= 1)
    height = first[hit, 2] + u[hit] * one[hit, 2] + v[hit] * two[hit, 2]
    # A line from below leaves a solid where the surface's outside faces up.
    turns = -numpy.sign(across[hit]).astype(int) * surface.sides[which[hit]].astype(int)
    return numpy.flatnonzero(hit), height, turns


def order_of(columns, tolerance):
    """How ``a`` is above or below ``b`` on the lines.

    ``clearance``: the least gap between a stretch of ``a`` and a stretch of ``b`` below it (None if there is none);
    ``contact``: the height of ``b`` there. ``over``: of the stretches of ``a`` with ``b`` on their line, the share that
    is over it; one with ``b`` on both sides counts half. ``lines``: the number of these stretches.
    """
    clearance = contact = None
    over, met = 0.0, 0
    for above, below in zip(columns.a, columns.b, strict=True):
        for low, high in above:
            beneath = [each for each in below if each[1] <= low + tolerance]
            overhead = [each for each in below if each[0] >= high - tolerance and each not in beneath]
            across = [each for each in below if each not in beneath and each not in overhead]
            if beneath or overhead or across:
                met += 1
                over += 0.5 if overhead and beneath else 1.0 if beneath else 0.0
            tops = [top for _, top in beneath]
            tops += [top for bottom, top in across if bottom < low < top]
            if tops:
                free = max(0.0, low - max(tops))
                if clearance is None or free < clearance:
                    clearance, contact = free, max(tops)
    return {"clearance": clearance, "contact": contact, "over": over / met if met else None, "lines": met}
