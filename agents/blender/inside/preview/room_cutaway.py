# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a room for a view: removes what of its shell is between the camera and the inside.

These are the faces in front of the inside that have it on their far side. A connected part of a mesh loses single faces
if it is around the inside, like a box that is the room; else it goes whole if most of it hides the inside, like a wall.
"""

import contextlib
import math

import bmesh

from .studio_scene import REACH

try:
    import numpy
except ImportError:  # some systems' Blenders lack it: rooms stay closed there
    numpy = None

_CELLS = 12  # of the map of the inside, on each axis of the picture
_NEAR = (-2, -1, 0, 1, 2)
_SLACK = 0.02 * REACH  # how far behind the nearest point inside a removed face may be
_EDGE_ON = 0.05
_MUCH = 0.4  # share of a part's area that hides the inside, from which it goes whole
_SOME = 0.1  # share of the inside in a part's box, from which the part is around it
_AT_ONCE = 20_000  # faces whose distances to the inside are computed together


class RoomCutaway:
    """Opens ``room`` (None: nothing to do) for one view at a time; ``fault`` is the reason if it cannot, else ""."""

    def __init__(self, studio, room):
        self._studio = studio
        self.fault = "this Blender's Python has no numpy" if room and numpy is None else ""
        room = None if self.fault else room
        self._inside = numpy.array(room.inside) if room else None
        self._walls = [_Wall(obj, self._inside) for obj in room.shell] if room else []

    @contextlib.contextmanager
    def towards(self, rotation):
        """A context in which it is open for a camera's rotation; yields the objects that were cut."""
        changed = []
        try:
            front = _Front(self._inside, rotation) if self._walls else None
            for wall in self._walls:
                obj, faces = wall.obj, wall.faces_before(front)
                if len(faces):
                    changed.append((obj, obj.data))
                if len(faces) == len(obj.data.polygons):
                    obj.hide_render = True
                elif len(faces):
                    obj.data = self._studio.owned(_without(obj.data, faces))
            yield [obj for obj, _ in changed]
        finally:
            for obj, data in changed:
                obj.hide_render = False
                obj.data = data


class _Front:
    """Which faces are in front of the inside, as a camera sees it."""

    def __init__(self, inside, rotation):
        self._turn = numpy.array(rotation)  # turns rows of points into camera space
        self._towards = self._turn[:, 2]
        seen = inside @ self._turn
        self._low = seen[:, :2].min(axis=0)
        self._cell = (seen[:, :2].max(axis=0) - self._low) / (_CELLS - 1)
        self._cell[self._cell == 0] = 1.0
        nearest = {}  # to the camera, of the places in a cell
        for cell, depth in zip(self._cells_of(seen).tolist(), seen[:, 2].tolist(), strict=True):
            nearest[tuple(cell)] = max(nearest.get(tuple(cell), -math.inf), depth)
        self._nearest = nearest

    def _cells_of(self, seen):
        return numpy.rint((seen[:, :2] - self._low) / self._cell).astype(int)

    def _inside_at(self, cell):
        """The depth of the inside's nearest point in a cell; infinite if there is no inside."""
        x, y = cell
        if cell in self._nearest:
            return self._nearest[cell]
        known = [(x + i, y + j) for i in _NEAR for j in _NEAR if (x + i, y + j) in self._nearest]
        return (
            self._nearest[min(known, key=lambda known_cell: math.dist(known_cell, cell))]
            if known
            else math.inf
        )

    def hides(self, wall):
        """A mask of the faces of a wall that are in front of the inside and have it on their far side."""
        facing = wall.normals @ self._towards
        seen = wall.centres @ self._turn
        cells, where = numpy.unique(self._cells_of(seen), axis=0, return_inverse=True)
        nearest = numpy.array([self._inside_at(tuple(cell)) for cell in cells.tolist()])[where.reshape(-1)]
        in_front = (abs(facing) >= _EDGE_ON) & (seen[:, 2] >= nearest - _SLACK)
        return in_front & (wall.is_turned_in != (facing > 0))


class _Wall:
    """An object ``obj`` of the shell; of its faces, in world space: ``centres``, ``normals``, and ``is_turned_in``,
    whether normals point to the inside."""

    def __init__(self, obj, inside):
        self.obj = obj
        mesh, matrix = obj.data, numpy.array(obj.matrix_world)
        linear = matrix[:3, :3]
        self.centres = _read(mesh.polygons, "center", 3) @ linear.T + matrix[:3, 3]
        # Transforms unit normals to world space, with the factor of their areas as length.
        turn = numpy.linalg.pinv(linear) * abs(numpy.linalg.det(linear))
        normals = _read(mesh.polygons, "normal", 3) @ turn
        lengths = numpy.linalg.norm(normals, axis=1)
        self.normals = normals / numpy.maximum(lengths, 1e-30)[:, None]
        self._areas = _read(mesh.polygons, "area", 1)[:, 0] * lengths
        self.is_turned_in = numpy.concatenate(
            [
                self._points_in(slice(at, at + _AT_ONCE), inside)
                for at in range(0, len(self.centres), _AT_ONCE)
            ]
        )
        own = (inside - matrix[:3, 3]) @ numpy.linalg.pinv(linear).T
        self._parts = [(part, _is_around(mesh, part, own)) for part in map(numpy.array, _parts(mesh))]

    def _points_in(self, faces, inside):
        """Whether the normals of faces point to the nearest points inside."""
        centres = self.centres[faces]
        away = ((centres[:, None] - inside[None]) ** 2).sum(axis=2)
        most = min(4, len(inside))
        near = numpy.argpartition(away, most - 1, axis=1)[:, :most]
        middles = inside[near].mean(axis=1)
        return numpy.einsum("ij,ij->i", self.normals[faces], middles - centres) > 0

    def faces_before(self, front):
        """The numbers of the faces to remove."""
        hides, off = front.hides(self), []
        for part, is_around in self._parts:
            hiding = part[hides[part]]
            if len(hiding) and is_around:
                off.append(hiding)
            elif self._areas[hiding].sum() > _MUCH * self._areas[part].sum():
                off.append(part)
        return numpy.concatenate(off) if off else numpy.array([], dtype=int)


def _is_around(mesh, part, inside):
    """Whether much of the inside, in the mesh's own space, is in the bounding box of a part."""
    vertices = sorted({at for number in part.tolist() for at in mesh.polygons[number].vertices})
    corners = numpy.array([mesh.vertices[at].co for at in vertices])
    within = ((corners.min(axis=0) < inside) & (inside < corners.max(axis=0))).all(axis=1)
    return within.mean() > _SOME


def _read(items, name, width):
    """A property of all items of a collection, a row for each."""
    flat = numpy.empty(width * len(items), dtype=numpy.float32)
    items.foreach_get(name, flat)
    return flat.reshape(-1, width).astype(float)


def _parts(mesh):
    """The numbers of a mesh's faces, one list for each connected part."""
    leader = list(range(len(mesh.vertices)))

    def lead(vertex):
        while leader[vertex] != vertex:
            leader[vertex] = leader[leader[vertex]]
            vertex = leader[vertex]
        return vertex

    for face in mesh.polygons:
        first, *others = face.vertices
        for vertex in others:
            leader[lead(vertex)] = lead(first)
    parts = {}
    for face in mesh.polygons:
        parts.setdefault(lead(face.vertices[0]), []).append(face.index)
    return parts.values()


def _without(mesh, faces):
    """A copy of a mesh without some faces."""
    copy, work = mesh.copy(), bmesh.new()
    work.from_mesh(copy)
    work.faces.ensure_lookup_table()
    bmesh.ops.delete(work, geom=[work.faces[number] for number in faces.tolist()], context="FACES")
    work.to_mesh(copy)
    work.free()
    return copy
