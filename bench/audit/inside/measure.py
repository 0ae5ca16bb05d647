# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how groups of objects stand to each other at the start, middle and end; see audit/relation_measures.py.

Call it after the facts were read, which switches off unbaked physics: nothing is simulated here.
"""

import bpy
import numpy
from mathutils import Vector

from .columns import Columns, order_of
from .json_values import number
from .sample_frames import frames_of, metres
from .surfaces import SurfaceBuilder

MOST_WHOLE = 60_000  # triangles; of more, only those near the other surface are used
_STARTS, _STEPS = 6, 8
_TOUCHING = 1e-6
_LEVEL = 0.7  # of a normal, upwards
_INSIDE_SAMPLES = 64  # points of a surface that are tested for being enclosed
_SIDES = [
    Vector(side).normalized()
    for side in ((1, 0.03, 0.02), (-1, 0.02, 0.03), (0.03, 1, 0.02), (0.02, -1, 0.03))
]
_ENDS = [Vector(end).normalized() for end in ((0.02, 0.03, 1), (0.03, 0.02, -1))]
_CORNERS = [Vector((x, y, z)).normalized() for x in (-1, 1.03) for y in (-1.05, 1) for z in (-1.02, 1.04)]
_AROUND = [*_SIDES, *_ENDS, *_CORNERS]
_ENCLOSED = 8 / 14  # of the directions: in a box without a lid, nine hit


def measure(pairs):
    """Measures pairs. Returns, per pair, {turn: measurements}; turns are 0 start, 1 middle, 2 end.

    A pair has ``a`` and ``b`` (names of objects), ``turns``, ``tolerance`` (metres), and in ``wants`` what to measure
    beyond the distance: ``depth``, ``columns`` (with depth), ``inside``, ``view``.
    """
    scene = bpy.context.scene
    builder = SurfaceBuilder(metres(scene))
    measured = {}
    results = [{} for _ in pairs]
    for turn, frame in enumerate(frames_of(scene)):
        if not any(turn in pair["turns"] for pair in pairs):
            continue
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        due = [(place, pair) for place, pair in enumerate(pairs) if turn in pair["turns"]]
        groups = list(dict.fromkeys(tuple(pair[side]) for _, pair in due for side in ("a", "b")))
        surfaces = dict(zip(groups, builder.surfaces(groups, graph), strict=True))
        view = _view(scene, graph)
        for place, pair in due:
            first, second = surfaces[tuple(pair["a"])], surfaces[tuple(pair["b"])]
            key = (id(first), id(second), pair["tolerance"], tuple(pair["wants"]), view)
            if key not in measured:
                measured[key] = _measured(first, second, pair["tolerance"], set(pair["wants"]), view)
            results[place][str(turn)] = {"frame": frame, **measured[key]}
    return results


def _view(scene, graph):
    """The direction (x, y) to the right of the camera, or of a view along +Y if there is none."""
    if scene.camera is None:
        return 1.0, 0.0
    x, y, _ = scene.camera.evaluated_get(graph).matrix_world.col[0].xyz
    length = (x * x + y * y) ** 0.5
    return (x / length, y / length) if length > 1e-3 else (1.0, 0.0)


def _measured(first, second, tolerance, wants, view):
    row = {"empty": [side for side, surface in (("a", first), ("b", second)) if surface.empty]}
    if row["empty"]:
        return row
    row["a_low"], row["a_high"], row["b_low"], row["b_high"] = (
        _rounded(each) for each in (first.low, first.high, second.low, second.high)
    )
    if "view" in wants:
        row["right"] = _along(first, second, view)
        row["near"] = _along(first, second, (view[1], -view[0]))
        return row
    pair = _relevant_parts(first, second, tolerance)
    gap, from_first, from_second = _gap(*pair)
    row["gap"] = number(gap)
    if "columns" in wants or ("depth" in wants and _overlap(first, second)):
        row |= _order_and_depth(first, second, pair, (from_first, from_second), tolerance)
    elif "depth" in wants:
        row["depth"] = 0.0
    if "inside" in wants:
        row["inside"] = number(_inside(first, second, tolerance))
    return row


def _overlap(first, second):
    return bool((first.low <= second.high).all() and (second.low <= first.high).all())


def _rounded(values):
    return [round(float(each), 5) + 0.0 for each in values]


def _along(first, second, axis):
    """The extents of both along a horizontal direction: [low, high of the first, low, high of the second]."""
    extents = []
    for surface in (first, second):
        reached = numpy.concatenate([surface.corners, surface.points])[:, :2] @ numpy.array(axis)
        extents += [reached.min(), reached.max()]
    return _rounded(extents)


def _relevant_parts(first, second, tolerance):
    """Both surfaces; of large ones only the part that can be nearest to the other, or in it."""
    surfaces = []
    for surface, other in ((first, second), (second, first)):
        if len(surface.faces) <= MOST_WHOLE:
            surfaces.append(surface)
            continue
        apart = numpy.maximum(numpy.maximum(surface.low - other.high, other.low - surface.high), 0)
        reach = float(numpy.linalg.norm(apart)) + max(10 * tolerance, 0.1)
        while (part := surface.part(other.low - reach, other.high + reach)) is None:
            reach *= 2
        surfaces.append(part)
    return surfaces


# Distance


def _gap(first, second):
    """(least distance, 0 if they intersect; points on the second nearest to the first's seeds, and the reverse)."""
    feet, reversed_feet = _nearest_points(first, second), _nearest_points(second, first)
    if first.tree is not None and second.tree is not None and first.tree.overlap(second.tree):
        return 0.0, feet[0], reversed_feet[0]
    best = _least_of_points(first, second, feet[1], reversed_feet[1])
    for surface, other, (points, lengths) in ((first, second, feet), (second, first, reversed_feet)):
        if surface.tree is None or other.tree is None:
            continue
        for place in numpy.argsort(lengths, kind="stable")[:_STARTS]:
            best = min(best, _settled_distance(points[place], surface.tree, other.tree))
    return (0.0 if best < _TOUCHING else best), feet[0], reversed_feet[0]


def _nearest_points(surface, other):
    """The points of the other nearest to this one's seeds, with their distances."""
    seeds = surface.seeds
    if other.tree is None:
        spread = numpy.linalg.norm(seeds[:, None] - other.points[None, :2000], axis=2)
        return other.points[spread.argmin(axis=1)], spread.min(axis=1)
    nearest = [other.tree.find_nearest(seed) for seed in seeds.tolist()]
    return numpy.array([tuple(each[0]) for each in nearest]), numpy.array([each[3] for each in nearest])


def _least_of_points(first, second, lengths, reversed_lengths):
    best = float(min(lengths.min(), reversed_lengths.min()))
    for surface, other in ((first, second), (second, first)):
        if len(surface.points) > len(surface.seeds) and other.tree is not None:
            best = min(best, *(other.tree.find_nearest(point)[3] for point in surface.points.tolist()))
    return best


def _settled_distance(point, tree, other_tree):
    """The distance after going from a point on one surface to the nearest on the other, and back, until it settles."""
    length = numpy.inf
    for _ in range(_STEPS):
        foot = tree.find_nearest(Vector(point))[0]
        point, _, _, now = other_tree.find_nearest(foot)
        if length - now < _TOUCHING:
            return min(length, now)
        length = now
    return length


# Over and in each other


def _order_and_depth(first, second, pair, feet, tolerance):
    """What vertical lines show: which is over which, how deep either is in the other, and what share of it."""
    on_second, on_first = feet
    columns = Columns(
        first,
        second,
        numpy.concatenate([first.seeds, on_first]),
        numpy.concatenate([second.seeds, on_second]),
    )
    row = {
        key: None if value is None else number(value) for key, value in order_of(columns, tolerance).items()
    }
    row["depth"] = number(_depth(columns, *pair))
    row["a_in_b"] = number(_share_in(first, columns.b, columns.places))
    row["b_in_a"] = number(_share_in(second, columns.a, columns.places))
    return row


def _depth(columns, first, second):
    """How deep they penetrate each other: the greatest distance to a surface of points of the other that are in it.

    A level sheet has no inside: of a solid that it cuts, the depth on the shallower side counts.
    """
    deepest = 0.0
    if first.tree is None or second.tree is None:
        return deepest
    for place, above, below in zip(columns.places.tolist(), columns.a, columns.b, strict=True):
        for stretches, other_stretches, near, far in (
            (above, below, first, second),
            (below, above, second, first),
        ):
            for low, high in stretches:
                for bottom, top in other_stretches:
                    inner = [z for z in {bottom, top} if low + _TOUCHING < z < high - _TOUCHING]
                    for z in inner:
                        deepest = max(deepest, near.tree.find_nearest((*place, z))[3])
                    if inner and bottom == top and _is_level(far.tree, (*place, top)):
                        ends = [far.tree.find_nearest((*place, z))[3] for z in (low, high)]
                        deepest = max(deepest, min(ends))
    return deepest


def _is_level(tree, point):
    normal = tree.find_nearest(point)[1]
    return abs(normal.z) > _LEVEL


def _share_in(surface, stretches, places):
    """The share of a surface's seeds that are in the other's solid."""
    stretches_at = {tuple(place): each for place, each in zip(places.tolist(), stretches, strict=True)}
    inside = sum(
        any(low + _TOUCHING < z < high - _TOUCHING for low, high in stretches_at.get((x, y), ()))
        for x, y, z in surface.seeds.tolist()
    )
    return inside / len(surface.seeds) if len(surface.seeds) else 0.0


def _inside(first, second, tolerance):
    """The share of the first's points that the second encloses, within its bounds grown by the tolerance."""
    seeds = first.seeds
    seeds = seeds[numpy.linspace(0, len(seeds) - 1, min(_INSIDE_SAMPLES, len(seeds))).astype(int)]
    within = ((seeds >= second.low - tolerance) & (seeds <= second.high + tolerance)).all(axis=1)
    if second.tree is None:
        return 0.0
    return sum(_enclosed(seed, second.tree) for seed in seeds[within].tolist()) / len(seeds)


def _enclosed(point, tree):
    hits = sum(tree.ray_cast(point, direction)[0] is not None for direction in _AROUND)
    return hits >= _ENCLOSED * len(_AROUND)
