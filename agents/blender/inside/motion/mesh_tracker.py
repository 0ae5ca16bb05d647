# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of a scene over many frames, kept as long as they do not change. Metres."""

import bpy
import numpy

from ..geometry.evaluated_meshes import TriangleMesh, transformed
from ..geometry.solids import MOST_TRIANGLES, Solid, Unmeasurable
from .contacts import TrackedSurface

_SAMPLES = 300  # of the vertices, and of the faces
_SAME = 1e-5  # how much the scale may change, in parts, and still count as the same
_EVENLY = (0.7548776662466927, 0.5698402909980532)  # steps that fill a square evenly


class TrackedBody:
    """An object's evaluated mesh without location and rotation: ``solid`` is the same at all frames if it is rigid.

    ``samples`` (n × 3) are points all over it, the same ones as long as it has as many vertices. ``low`` and ``high``
    are the corners of its box along the world's axes.
    """

    def __init__(self, obj):
        self.name = obj.name
        self._obj = obj
        self._is_rigid = not obj.modifiers and getattr(obj.data, "shape_keys", None) is None
        self._shape = self._solid = self._samples = self._inwards = None
        self.frame = self.before = None

    def update(self, frame, graph):
        """Updates it to a frame."""
        if frame == self.frame:
            return
        self._evaluated = self._obj.evaluated_get(graph)
        matrix = self._evaluated.matrix_world
        turn = matrix.to_quaternion().to_matrix()
        shape = turn.transposed() @ matrix.to_3x3()
        now = numpy.array(turn, float), numpy.array(matrix.translation, float)
        self.before = self._pose if self.frame == frame - 1 else now
        self._pose, self.frame = now, frame
        if (
            not self._is_rigid
            or self._shape is None
            or any(
                (shape[row] - self._shape[row]).length > _SAME * (1 + shape[row].length) for row in range(3)
            )
        ):
            self._shape, self._solid, self._samples, self._inwards = shape, None, None, None
        corners = transformed(numpy.array(self._evaluated.bound_box), matrix)
        self.low, self.high = corners.min(axis=0), corners.max(axis=0)

    @property
    def solid(self):
        """Its triangles in its own space. Raises Unmeasurable."""
        if self._solid is None:
            mesh = TriangleMesh(self._evaluated.data)
            if not 0 < len(mesh.triangles) <= MOST_TRIANGLES:
                raise Unmeasurable(f"{self.name!r} has {len(mesh.triangles)} triangles")
            points = transformed(mesh.points, self._shape.to_4x4())
            if not numpy.isfinite(points).all():
                raise Unmeasurable(f"{self.name!r} has coordinates that are not finite")
            self._solid = Solid(self.name, points, mesh.triangles)
        return self._solid

    @property
    def inwards(self):
        """-1 if normals point out of a closed mesh, 1 if they point into it."""
        if self._inwards is None:
            a, b, c = (self.solid.points[self.solid.triangles[:, corner]] for corner in range(3))
            self._inwards = -1 if numpy.einsum("ij,ij->", a, numpy.cross(b, c)) >= 0 else 1
        return self._inwards

    @property
    def samples(self):
        """Points all over it in its own space."""
        if self._samples is None:
            points = self.solid.points
            self._samples = points[:: -(-len(points) // _SAMPLES)]
            if self._is_rigid:
                self._samples = numpy.concatenate([self._samples, surface_points(self.solid, _SAMPLES)])
        return self._samples

    def to_world(self, places, *, before=False):
        """Transforms points from its own space to the world, as of this frame or of the one before."""
        turn, place = self.before if before else self._pose
        return places @ turn.T + place

    def to_own_space(self, places, *, before=False):
        """Transforms points from the world to its own space, as of this frame or of the one before."""
        turn, place = self.before if before else self._pose
        return (places - place) @ turn


def surface_points(solid, count):
    """About ``count`` points spread over the triangles of a solid by area; always the same ones."""
    corners = solid.points[solid.triangles]
    sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    reach = numpy.cumsum(numpy.linalg.norm(numpy.cross(*sides), axis=1))
    if not len(reach) or reach[-1] <= 0:
        return solid.points[:0]
    chosen = numpy.searchsorted(reach, (numpy.arange(count) + 0.5) / count * reach[-1])
    u, v = (numpy.outer(numpy.arange(1, count + 1), _EVENLY) % 1.0).T
    beyond = u + v > 1
    u, v = numpy.where(beyond, 1 - u, u), numpy.where(beyond, 1 - v, v)
    return corners[chosen, 0] + u[:, None] * sides[0][chosen] + v[:, None] * sides[1][chosen]


class MeshTracker:
    """The surfaces and bodies of a scene at the current frame, made when needed."""

    def __init__(self):
        self._surfaces, self._bodies = {}, {}
        self._frame = self._graph = None

    def enter(self, frame, graph):
        """Updates everything to a frame."""
        self._frame, self._graph = frame, graph
        for surface in self._surfaces.values():
            surface.update(graph)
        for body in self._bodies.values():
            body.update(frame, graph)

    def surface(self, name):
        """The surface on which distances are measured. Raises Unmeasurable."""
        if name not in self._surfaces:
            self._surfaces[name] = TrackedSurface(mesh_object(name))
            self._surfaces[name].update(self._graph)
        return self._surfaces[name]

    def body(self, name):
        """The body in which depths are measured. Raises Unmeasurable."""
        if name not in self._bodies:
            self._bodies[name] = TrackedBody(mesh_object(name))
            self._bodies[name].update(self._frame, self._graph)
        return self._bodies[name]


def mesh_object(name):
    """The object of that name. Raises Unmeasurable if there is none, or it is not a mesh."""
    obj = bpy.context.view_layer.objects.get(name)
    if obj is None:
        raise Unmeasurable(f"there is no object {name!r} in the view layer")
    if obj.type != "MESH":
        raise Unmeasurable(f"{name!r} is not a mesh")
    return obj
