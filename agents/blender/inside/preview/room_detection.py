# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the things on a stage stand in a room, where in it there is space, and what encloses it.

A place is *inside* if level rays from it run into large things nearly all around. What rays from inside meet last,
on their way out, is the room's *shell*. Without walls, a roof over most of the things is one. Lengths are the stage's,
on which what is framed is ``REACH`` across.
"""

import math

import bpy
from mathutils import Matrix, Vector

from .studio_scene import REACH

_WALL = 0.3 * REACH  # a thing of this size can be a wall
_PART = 0.12 * REACH  # and of this size, under a roof, a part of a wall
_FURNITURE = 0.45 * REACH  # larger things can be a roof, and do not tell whether there is a room
_ON_WALL = 0.04 * REACH  # what lies this flat against the shell belongs to it
_ABOVE_TOP = 0.005 * REACH
_STEP = 1e-4 * REACH
_MOST_FACES = 200_000  # of a thing that rays are sent against
_MOST_THINGS = 60
_MOST_TOPS = 60
_MOST_HITS = 8
_SENDERS = 40  # places from which the shell is looked for
_SOME = 0.4  # share of the things, or of the space, that makes it a room
_GRID = (6, 6, 4)
_AROUND = [
    Vector((math.cos(turn), math.sin(turn), math.tan(math.radians(rise)))).normalized()
    for turn, rise in ((math.tau * at / 12 + 0.1, (5, 20, 12)[at % 3]) for at in range(12))
]
_UP = [
    Vector(way).normalized()
    for way in ((0, 0.02, 1), (1, 0.1, 1.6), (-0.1, 1, 1.6), (-1, -0.1, 1.6), (0.1, -1, 1.6))
]


class Room:
    """``inside``: places spread over its space; ``shell``: the objects of the stage that enclose it."""

    def __init__(self, inside, shell):
        self.inside, self.shell = inside, shell


def large_pieces(stage, pieces):
    """Those that may enclose something, the largest first."""
    sized = [(_size(stage, piece), at) for at, piece in enumerate(pieces)]
    large = sorted((entry for entry in sized if entry[0] >= _PART), reverse=True)[:_MOST_THINGS]
    return [pieces[at] for _, at in large if _is_castable(pieces[at])]


def find_room(stage, placed, boxes):
    """The room around most of the things, or what lies over most of them like a roof; None if there is neither.

    ``placed`` are (piece, its object) for the large pieces, the only ones on the stage so far; ``boxes`` those of all
    things, in the open scene.
    """
    if not placed:
        return None
    rays = _Rays(stage, placed)
    tops = [_top(stage, box) for box in boxes if box.diagonal * stage.scale <= _FURNITURE]
    tops = tops[:: max(1, len(tops) // _MOST_TOPS)]
    grid = _grid(stage, placed)
    within = [top for top in tops if rays.is_inside(top)]
    if tops and len(within) < _SOME * len(tops):
        return _under_roof(rays, tops, grid)
    # A solid is no room: with nothing in it, only the fronts of faces are walls.
    inside = [place for place in grid if rays.is_inside(place, fronts_only=not tops)]
    if not tops and len(inside) < _SOME * len(grid):
        return None
    inside = inside or within
    shell = rays.outermost(inside)
    return Room(inside, shell) if shell else None


def _under_roof(rays, tops, grid):
    """A room without walls: what lies over most of the things, and the space below."""
    over = [rays.roof(top) for top in tops]
    roofs = [roof for roof in set(over) - {None} if over.count(roof) >= _SOME * len(tops)]
    inside = [place for place in grid if rays.roof(place) in roofs] if roofs else []
    return Room(inside, roofs) if inside else None


class _Rays:
    """Rays against the large things on a stage."""

    def __init__(self, stage, placed):
        self._scene, self._graph = stage.scene, stage.update()
        self._objects = {obj.name: obj for _, obj in placed}
        self._sizes = {obj.name: _size(stage, piece) for piece, obj in placed}

    def is_inside(self, place, *, fronts_only=False):
        """Whether large things are nearly all around, of smaller ones if there is a roof above them."""

        def meets(direction, size):
            hits = self._hits(place, direction)
            return any(self._sizes[name] >= size and (front or not fronts_only) for name, _, front in hits)

        if self._is_roofed(place):
            return sum(meets(direction, _PART) for direction in _AROUND) >= 8
        return sum(meets(direction, _WALL) for direction in _AROUND) >= 9

    def outermost(self, inside):
        """The things that rays from inside mostly meet last."""
        met, last = {}, {}
        for place in inside[:: max(1, len(inside) // _SENDERS)]:
            is_roofed = self._is_roofed(place)
            smallest = _PART if is_roofed else _WALL
            for direction in _AROUND + (_UP if is_roofed else []):
                hits = self._hits(place, direction)
                first = {}
                for name, distance, _ in hits:
                    if self._sizes[name] >= smallest:
                        first.setdefault(name, distance)
                for name, distance in first.items():
                    met[name] = met.get(name, 0) + 1
                    last[name] = last.get(name, 0) + (
                        name == hits[-1][0] or distance > hits[-1][1] - _ON_WALL
                    )
        return [self._objects[name] for name in met if last[name] >= 0.5 * met[name]]

    def roof(self, place):
        """The outermost thing straight above, if it is large."""
        hits = self._hits(place, _UP[0])
        return self._objects[hits[-1][0]] if hits and self._sizes[hits[-1][0]] > _FURNITURE else None

    def _is_roofed(self, place):
        return (
            sum(any(self._sizes[hit[0]] > _FURNITURE for hit in self._hits(place, way)) for way in _UP) >= 4
        )

    def _hits(self, origin, direction):
        """(name, distance, whether the front of a face was met) along a ray, nearest first."""
        start, distance, hits = origin, 0.0, []
        for _ in range(_MOST_HITS):
            hit, place, normal, _, obj, _ = self._scene.ray_cast(
                self._graph, start, direction, distance=4 * REACH
            )
            if not hit:
                break
            distance += (place - start).length + _STEP
            hits.append((obj.name, distance, normal.dot(direction) < 0))
            start = place + direction * _STEP
        return hits


def _is_castable(piece):
    mesh = piece.data
    if not piece.is_solid or piece.is_liquid or not isinstance(mesh, bpy.types.Mesh):
        return False
    return len(mesh.polygons) <= _MOST_FACES


def _size(stage, piece):
    return (piece.high - piece.low).length * stage.scale


def _on(stage, place):
    return stage.placed(Matrix.Translation(place)).translation


def _top(stage, box):
    """A place just above a thing."""
    return _on(stage, Vector((*box.centre.xy, box.high.z))) + Vector((0, 0, _ABOVE_TOP))


def _grid(stage, placed):
    """Places spread evenly over where the large things and what is framed are both."""
    ends = [_on(stage, end) for piece, _ in placed for end in (piece.low, piece.high)]
    low = [max(-REACH / 2, min(end[axis] for end in ends)) for axis in range(3)]
    high = [min(REACH / 2, max(end[axis] for end in ends)) for axis in range(3)]
    counts = [range(count) for count in _GRID]
    return [
        Vector(low[axis] + (high[axis] - low[axis]) * (at[axis] + 0.5) / _GRID[axis] for axis in range(3))
        for at in ((x, y, z) for x in counts[0] for y in counts[1] for z in counts[2])
    ]
