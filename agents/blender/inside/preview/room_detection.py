# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds out whether the objects of a studio scene are in a room, where it has space, and what encloses it.

A point is *inside* if level rays from it hit large objects nearly all around. What rays from inside hit last, on their
way out, is the room's *shell*, but for what moves, such as doors. A roof over most of the objects counts as a room
without walls. Lengths are those of the studio scene, in which what is framed is ``REACH`` across.
"""

import itertools
import math

import bpy
from mathutils import Matrix, Vector

from .studio_scene import REACH

_WALL = 0.3 * REACH  # an object of this size can be a wall
_PART = 0.12 * REACH  # and of this size, under a roof, a part of a wall
_FURNITURE = 0.45 * REACH  # larger objects can be a roof, and do not count as content of a room
_ON_WALL = 0.04 * REACH  # a wall that is this close to the shell belongs to it
_ABOVE_TOP = 0.005 * REACH
_LOW = (
    0.08 * REACH
)  # what has something so near above it is a leg, a post or in a shelf, and tells of no room
_STEP = 1e-4 * REACH
_MOST_FACES = 200_000  # of an object that rays are cast against
_MOST_THINGS = 60
_MOST_TOPS = 60
_MOST_HITS = 8
_SENDERS = 40  # points from which the shell is searched for
_SOME = 0.4  # share of the objects, or of the space, inside a room
_GRID = (6, 6, 4)
_AROUND = [
    Vector((math.cos(turn), math.sin(turn), math.tan(math.radians(rise)))).normalized()
    for turn, rise in ((math.tau * at / 12 + 0.1, (5, 20, 12)[at % 3]) for at in range(12))
]
_OPEN, _OPEN_BELOW_ROOF = 3, 4  # of these, ways out of a room
_UP = [
    Vector(way).normalized()
    for way in ((0, 0.02, 1), (1, 0.1, 1.6), (-0.1, 1, 1.6), (-1, -0.1, 1.6), (0.1, -1, 1.6))
]


class Room:
    """``inside``: points spread over its space; ``shell``: the objects that enclose it."""

    def __init__(self, inside, shell):
        self.inside, self.shell = inside, shell


def large_pieces(studio, pieces):
    """The pieces that may enclose something, the largest first."""
    sized = [(_size(studio, piece), at) for at, piece in enumerate(pieces)]
    large = sorted((entry for entry in sized if entry[0] >= _PART), reverse=True)[:_MOST_THINGS]
    return [pieces[at] for _, at in large if _is_castable(pieces[at])]


def find_room(studio, placed, boxes):
    """The room around most of the objects, or under a roof over most of them; None if there is neither.

    ``placed``: (piece, its object) for the large pieces, the only ones in the studio scene so far; ``boxes``: those of
    all objects, in the open scene.
    """
    if not placed:
        return None
    rays = _Rays(studio, placed)
    tops = [_top(studio, box) for box in boxes if box.diagonal * studio.scale <= _FURNITURE]
    tops = [top for top in tops[:: max(1, len(tops) // _MOST_TOPS)] if not rays.is_low(top)]
    grid = _grid(studio, placed)
    within = [top for top in tops if rays.is_inside(top)]
    if tops and len(within) < _SOME * len(tops):
        return _under_roof(rays, tops, grid)
    # A solid is not a room: if nothing is in it, only the fronts of faces count as walls.
    inside = [place for place in grid if rays.is_inside(place, fronts_only=not tops)]
    if not tops and len(inside) < _SOME * len(grid):
        return None
    inside = inside or within
    movers = {obj for piece, obj in placed if piece.is_mover}
    shell = [obj for obj in rays.outermost(inside) if obj not in movers]
    return Room(inside, shell) if shell else None


def _under_roof(rays, tops, grid):
    """A room without walls: a roof over most of the objects, and the space below."""
    over = [rays.roof(top) for top in tops]
    roofs = [roof for roof in set(over) - {None} if over.count(roof) >= _SOME * len(tops)]
    inside = [place for place in grid if rays.roof(place) in roofs] if roofs else []
    return Room(inside, roofs) if inside else None


class _Rays:
    """Casts rays against the large objects of the studio scene."""

    def __init__(self, studio, placed):
        self._scene, self._graph = studio.scene, studio.update()
        self._objects = {obj.name: obj for _, obj in placed}
        self._sizes = {obj.name: _size(studio, piece) for piece, obj in placed}

    def is_inside(self, place, *, fronts_only=False):
        """Whether large objects are nearly all around; under a roof, smaller ones count as well."""

        around = [self._hits(place, direction) for direction in _AROUND]

        def meets(hits, size):
            # It looks out of a solid, beside which others may stand.
            if fronts_only and hits and not hits[0][2]:
                return False
            return any(self._sizes[name] >= size and (front or not fronts_only) for name, _, front in hits)

        # Rays that leave a solid may go on to another one beside it.
        if fronts_only and sum(map(_leaves_solid, around)) > _OPEN:
            return False
        if self._is_roofed(place):
            return sum(meets(hits, _PART) for hits in around) >= len(_AROUND) - _OPEN_BELOW_ROOF
        return sum(meets(hits, _WALL) for hits in around) >= len(_AROUND) - _OPEN

    def is_low(self, place):
        """Whether something is right above."""
        hits = self._hits(place, _UP[0])
        return bool(hits) and hits[0][1] < _LOW

    def outermost(self, inside):
        """The objects that rays from inside mostly hit last."""
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
                    is_wall = self._sizes[name] >= _WALL and distance > hits[-1][1] - _ON_WALL
                    last[name] = last.get(name, 0) + (name == hits[-1][0] or is_wall)
        return [self._objects[name] for name in met if last[name] >= 0.5 * met[name]]

    def roof(self, place):
        """The outermost object straight above, if it is large."""
        hits = self._hits(place, _UP[0])
        return self._objects[hits[-1][0]] if hits and self._sizes[hits[-1][0]] > _FURNITURE else None

    def _is_roofed(self, place):
        return (
            sum(any(self._sizes[hit[0]] > _FURNITURE for hit in self._hits(place, way)) for way in _UP) >= 4
        )

    def _hits(self, origin, direction):
        """(name, distance, whether the front of a face was hit) along a ray, nearest first."""
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


def _leaves_solid(hits):
    """Whether a ray comes out of something that it has not gone into: then it begins in a solid, not in a room."""
    within = itertools.accumulate(1 if front else -1 for _, _, front in hits)
    return any(depth < 0 for depth in within)


def _is_castable(piece):
    mesh = piece.data
    if not piece.is_solid or piece.is_liquid or piece.is_helper or not isinstance(mesh, bpy.types.Mesh):
        return False
    return len(mesh.polygons) <= _MOST_FACES


def _size(studio, piece):
    return (piece.high - piece.low).length * studio.scale


def _in_studio(studio, place):
    return studio.placed(Matrix.Translation(place)).translation


def _top(studio, box):
    """A point just above a box."""
    return _in_studio(studio, Vector((*box.centre.xy, box.high.z))) + Vector((0, 0, _ABOVE_TOP))


def _grid(studio, placed):
    """Points spread evenly over the space of both the large objects and what is framed."""
    ends = [_in_studio(studio, end) for piece, _ in placed for end in (piece.low, piece.high)]
    low = [max(-REACH / 2, min(end[axis] for end in ends)) for axis in range(3)]
    high = [min(REACH / 2, max(end[axis] for end in ends)) for axis in range(3)]
    counts = [range(count) for count in _GRID]
    return [
        Vector(low[axis] + (high[axis] - low[axis]) * (at[axis] + 0.5) / _GRID[axis] for axis in range(3))
        for at in ((x, y, z) for x in counts[0] for y in counts[1] for z in counts[2])
    ]
