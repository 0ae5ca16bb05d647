# SPDX-License-Identifier: GPL-3.0-or-later
"""The extents of evaluated geometry in the world, as of the last evaluation."""

import math

import bpy
from mathutils import Vector

from .rna_values import numbers

MOST_VERTICES = 4_000_000  # of one readout, in rotated meshes, which are measured vertex by vertex
MOST_INSTANCES = 20_000
_WITHOUT = {"EMPTY", "LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE"}
_BY_POINTS = {"CURVE"}  # whose bounding box has each point with its radius, which is 1 and no thickness
_AS_MESH = {"CURVE", "SURFACE", "FONT", "META"}


class Extent:
    """A box along the world's axes, in units of the scene. ``rough``: it may be larger than its contents."""

    def __init__(self, low, high, rough=False):
        self.low, self.high, self.rough = list(low), list(high), rough

    def join(self, other):
        """Extends it to include another one."""
        self.low = [min(pair) for pair in zip(self.low, other.low, strict=True)]
        self.high = [max(pair) for pair in zip(self.high, other.high, strict=True)]
        self.rough |= other.rough

    def as_dict(self):
        """It as JSON: ``min``, ``max``, ``size``, and ``rough`` if it is."""
        size = [high - low for low, high in zip(self.low, self.high, strict=True)]
        entry = {"min": numbers(self.low), "max": numbers(self.high), "size": numbers(size)}
        if self.rough:
            entry["rough"] = True
        return entry


class ExtentReader:
    """Measures objects in the evaluated scene, without changing it."""

    def __init__(self, graph):
        self._graph = graph
        self._vertices = MOST_VERTICES
        self._instances = None
        self.instances_cut = False

    def evaluated(self, obj):
        """The evaluated object; None for one that is not evaluated (excluded, or hidden from the viewport)."""
        evaluated = obj.evaluated_get(self._graph)
        return evaluated if evaluated.is_evaluated else None

    def measure(self, obj, evaluated):
        """(Extent or None, number of instances). An object that is not evaluated is measured by its original data."""
        box = None if obj.type in _WITHOUT else self._own(obj if evaluated is None else evaluated)
        instanced = self._made_by(obj)
        if instanced is None:
            return box, 0
        count, around = instanced
        if box is None:
            box = Extent(around.low, around.high, around.rough)
        else:
            box.join(around)
        return box, count

    def _own(self, obj):
        corners = obj.bound_box
        low, high = Vector(corners[0]), Vector(corners[6])
        data = obj.data
        if obj.type == "MESH" and not len(data.vertices):
            return None
        matrix = obj.matrix_world
        if not _is_rotated(matrix) and obj.type not in _BY_POINTS:
            return _transformed_box(matrix, low, high) if low != high or obj.type == "MESH" else None
        if obj.type == "MESH":
            return self._by_vertices(data, matrix) or _transformed_box(matrix, low, high, rough=True)
        if obj.type in _AS_MESH:
            try:
                return self._by_vertices(obj.to_mesh(), matrix) or _transformed_box(
                    matrix, low, high, rough=True
                )
            except RuntimeError:
                pass
            finally:
                obj.to_mesh_clear()
        return _transformed_box(matrix, low, high, rough=True) if low != high else None

    def _by_vertices(self, mesh, matrix):
        count = len(mesh.vertices) if mesh is not None else 0
        if not count or count > self._vertices:
            return None
        try:
            import numpy
        except ImportError:
            return None
        self._vertices -= count
        places = numpy.empty(3 * count, numpy.float32)
        mesh.vertices.foreach_get("co", places)
        turn = numpy.array(matrix.to_3x3(), numpy.float32)
        placed = places.reshape(count, 3) @ turn.T
        shift = matrix.translation
        low, high = placed.min(axis=0), placed.max(axis=0)
        return Extent(
            (float(low[i]) + shift[i] for i in range(3)), (float(high[i]) + shift[i] for i in range(3))
        )

    def _made_by(self, obj):
        if self._instances is None:
            self._instances = self._all_instances()
        return self._instances.get(obj.name_full)

    def _all_instances(self):
        """{object that makes them: [count, Extent]} for instances of objects, collections and geometry nodes."""
        by_maker = {}
        if not any(_may_instance(obj) for obj in self._graph.objects):
            return by_maker
        left = MOST_INSTANCES
        for instance in self._graph.object_instances:
            if not instance.is_instance:
                continue
            left -= 1
            if left < 0:
                self.instances_cut = True
                break
            obj, maker = instance.object, instance.parent
            if obj is None or maker is None or obj.type in _WITHOUT:
                continue
            matrix = instance.matrix_world
            if maker.type in _AS_MESH and obj.original == maker.original and matrix == maker.matrix_world:
                continue  # the mesh of a text or curve itself, not an instance
            corners = obj.bound_box
            rough = _is_rotated(matrix) or obj.type in _BY_POINTS
            box = _transformed_box(matrix, Vector(corners[0]), Vector(corners[6]), rough=rough)
            entry = by_maker.setdefault(maker.original.name_full, [0, None])
            entry[0] += 1
            if entry[1] is None:
                entry[1] = box
            else:
                entry[1].join(box)
        return {name: entry for name, entry in by_maker.items() if entry[1] is not None}


def _may_instance(obj):
    if obj.is_instancer or obj.instance_type != "NONE":
        return True
    return any(modifier.type in {"NODES", "PARTICLE_SYSTEM"} for modifier in obj.modifiers)


def _is_rotated(matrix):
    """Whether a box along the object's axes is not along the world's axes."""
    largest = max(abs(matrix[row][column]) for row in range(3) for column in range(3))
    limit = 1e-6 * largest if math.isfinite(largest) else 0.0
    return any(sum(abs(matrix[row][column]) > limit for column in range(3)) > 1 for row in range(3))


def _transformed_box(matrix, low, high, rough=False):
    """The box around a box that ``matrix`` has moved."""
    middle, half = (low + high) / 2, (high - low) / 2
    centre = matrix @ middle
    reach = [sum(abs(matrix[row][column]) * half[column] for column in range(3)) for row in range(3)]
    return Extent((centre[i] - reach[i] for i in range(3)), (centre[i] + reach[i] for i in range(3)), rough)


def evaluated_graph():
    """The evaluated scene at its current frame; evaluates only what has changed since the last time."""
    return bpy.context.evaluated_depsgraph_get()
