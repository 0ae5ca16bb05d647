# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures where objects are relative to each other (see agents.protocol.measures.position)."""

import math

import bpy
import numpy
from mathutils import Vector

from ..geometry.solids import Unmeasurable

_CELLS = 40  # along each side of a plan view, from whose centres rays go up and down
_CORNERS = 2000
_INSET = 0.98  # corners are moved inwards: at a wall they could be on either side of it
_UP = Vector((0, 0, 1))


def over(request, solids):
    """How much of ``a`` is over ``b`` in plan view, and how deep it is sunk into it there."""
    a, b = solids.joined(request["a"]), solids.joined(request["b"])
    cells = _undersides(a)
    corners = a.points[:: len(a.points) // _CORNERS + 1]
    middle = (a.low + a.high) / 2
    drawn = numpy.column_stack([middle[:2] + _INSET * (corners[:, :2] - middle[:2]), corners[:, 2]]).tolist()
    tops = [_top(b, place) for place in cells or drawn]
    share = sum(top is not None for top in tops) / len(tops)
    result = {"share": share, "sunk": None, "at": None}
    deepest = [*zip(cells or drawn, tops, strict=True)]
    if cells:
        deepest += [(place, _top(b, place)) for place in drawn]
    for place, top in deepest:
        if top is not None and (result["sunk"] is None or top - place[2] > result["sunk"]):
            result.update(sunk=top - place[2], at=tuple(place))
    return result


def _undersides(solid):
    """The lowest point of a solid in each cell of its plan view that it covers."""
    size = solid.high - solid.low
    below = solid.low[2] - 1 - size[2]
    points = []
    for column in range(_CELLS):
        for row in range(_CELLS):
            x, y = (solid.low + (numpy.array((column, row, 0)) + 0.5) / _CELLS * size)[:2]
            hit = solid.tree.ray_cast(Vector((x, y, below)), _UP)[0]
            if hit is not None:
                points.append(tuple(hit))
    return points


def _top(solid, place):
    """The highest point of a solid over or under a place; None if it is not there."""
    x, y = place[:2]
    if not (solid.low[0] <= x <= solid.high[0] and solid.low[1] <= y <= solid.high[1]):
        return None
    hit = solid.tree.ray_cast(Vector((x, y, solid.high[2] + 1)), -_UP)[0]
    return None if hit is None else hit[2]


def beside(request, solids):
    """How far ``a`` is off a direction from ``b`` (degrees), and how wide the gap between them is."""
    axes = axes_of(request["of"], level=request["level"]) if request["of"] else numpy.eye(3)
    side = axes[request["axis"]] * request["way"]
    a, b = solids.joined(request["a"]).points, solids.joined(request["b"]).points
    (low_a, high_a), (low_b, high_b) = (
        (some.min(axis=0), some.max(axis=0)) for some in (a @ axes.T, b @ axes.T)
    )
    middle_a, middle_b = (low_a + high_a) / 2, (low_b + high_b) / 2
    along = (middle_a - middle_b)[request["axis"]] * request["way"]
    off = numpy.maximum(0.0, numpy.maximum(middle_a - high_b, low_b - middle_a))
    off[request["axis"]] = off[2] = 0.0  # left of something means left at any height
    directions = [side, *numpy.eye(3), (middle_a - middle_b) @ axes]
    for name in request["turned"]:
        directions += [*axes_of(name)]
    gap = max(
        float((a @ direction).min() - (b @ direction).max())
        for direction in _within(directions, side, math.radians(request["cone"]))
    )
    return {
        "angle": math.degrees(math.atan2(float(numpy.linalg.norm(off)), along)),
        "gap": gap,
        "at": (middle_a @ axes).tolist(),
    }


def _within(directions, side, cone):
    """The directions, or their opposites, within an angle of ``side``, as unit vectors."""
    for direction in directions:
        length = numpy.linalg.norm(direction)
        if length > 0:
            unit = direction / length * (1 if direction @ side >= 0 else -1)
            if unit @ side >= math.cos(cone) - 1e-9:
                yield unit


def axes_of(name, *, level=False):
    """The unit axes of an object at the current frame, as rows; with its X brought level, and Z up."""
    obj = bpy.context.scene.objects.get(name)
    if obj is None:
        raise Unmeasurable(f"there is no object {name!r} in the scene")
    matrix = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world
    axes = numpy.array(matrix, dtype=float)[:3, :3].T
    if level:
        across = numpy.array((axes[0][0], axes[0][1], 0.0))
        axes = numpy.array([across, numpy.cross((0, 0, 1), across), (0, 0, 1)])
    lengths = numpy.linalg.norm(axes, axis=1)
    if not (numpy.isfinite(axes).all() and (lengths > 1e-6).all()):
        what = "left and right: its X axis is vertical" if level else "axes: its scale is zero"
        raise Unmeasurable(f"{name!r} has no {what}")
    return axes / lengths[:, None]
