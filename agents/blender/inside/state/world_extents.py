# SPDX-License-Identifier: GPL-3.0-or-later
"""How far evaluated geometry reaches in the world, as it stands after the last evaluation."""

import math

import bpy
from mathutils import Vector

from .rna_values import numbers

MOST_VERTICES = 4_000_000  # of one readout whose turned meshes are measured vertex by vertex
MOST_INSTANCES = 20_000
_WITHOUT = {"EMPTY", "LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE"}
_AS_MESH = {"CURVE", "SURFACE", "FONT", "META"}


class Box:
    """A box along the world's axes, in units of the scene. ``rough``: it may be larger than what is in it."""

    def __init__(self, low, high, rough=False):
        self.low, self.high, self.rough = list(low), list(high), rough

    def join(self, other):
        """Makes it hold another one as well."""
        self.low = [min(pair) for pair in zip(self.low, other.low, strict=True)]
        self.high = [max(pair) for pair in zip(self.high, other.high, strict=True)]
        self.rough |= other.rough

    def told(self):
        """It as JSON: ``min``, ``max``, ``size``, and ``rough`` if it is."""
        size = [high - low for low, high in zip(self.low, self.high, strict=True)]
        told = {"min": numbers(self.low), "max": numbers(self.high), "size": numbers(size)}
        if self.rough:
            told["rough"] = True
        return told


class Extents:
    """Measures objects through the evaluated scene, of which nothing is changed."""

    def __init__(self, graph):
        self._graph = graph
        self._vertices = MOST_VERTICES
        self._instances = None
        self.instances_cut = False

    def evaluated(self, thing):
        """The evaluated object; None for one that is not evaluated (excluded, or hidden from the viewport)."""
        found = thing.evaluated_get(self._graph)
        return found if found.is_evaluated else None

    def measure(self, thing, evaluated):
        """(Box or None, number of instances). An object that is not evaluated is measured as its data are."""
        box = None if thing.type in _WITHOUT else self._own(thing if evaluated is None else evaluated)
        made = self._made_by(thing)
        if made is None:
            return box, 0
        count, around = made
        if box is None:
            box = Box(around.low, around.high, around.rough)
        else:
            box.join(around)
        return box, count

    def _own(self, thing):
        corners = thing.bound_box
        low, high = Vector(corners[0]), Vector(corners[6])
        data = thing.data
        if thing.type == "MESH" and not len(data.vertices):
            return None
        matrix = thing.matrix_world
        if not _turned(matrix):
            return _moved(matrix, low, high) if low != high or thing.type == "MESH" else None
        if thing.type == "MESH":
            return self._by_vertices(data, matrix) or _moved(matrix, low, high, rough=True)
        if thing.type in _AS_MESH:
            try:
                return self._by_vertices(thing.to_mesh(), matrix) or _moved(matrix, low, high, rough=True)
            except RuntimeError:
                pass
            finally:
                thing.to_mesh_clear()
        return _moved(matrix, low, high, rough=True) if low != high else None

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
        return Box(
            (float(low[i]) + shift[i] for i in range(3)), (float(high[i]) + shift[i] for i in range(3))
        )

    def _made_by(self, thing):
        if self._instances is None:
            self._instances = self._all_instances()
        return self._instances.get(thing.name_full)

    def _all_instances(self):
        """{object that makes them: [count, Box]} of instances of objects, collections and nodes."""
        found = {}
        if not any(_may_instance(thing) for thing in self._graph.objects):
            return found
        left = MOST_INSTANCES
        for instance in self._graph.object_instances:
            if not instance.is_instance:
                continue
            left -= 1
            if left < 0:
                self.instances_cut = True
                break
            thing, maker = instance.object, instance.parent
            if thing is None or maker is None or thing.type in _WITHOUT:
                continue
            matrix = instance.matrix_world
            if maker.type in _AS_MESH and thing.original == maker.original and matrix == maker.matrix_world:
                continue  # what a text or curve looks like, not what it makes
            corners = thing.bound_box
            box = _moved(matrix, Vector(corners[0]), Vector(corners[6]), rough=_turned(matrix))
            entry = found.setdefault(maker.original.name_full, [0, None])
            entry[0] += 1
            if entry[1] is None:
                entry[1] = box
            else:
                entry[1].join(box)
        return {name: entry for name, entry in found.items() if entry[1] is not None}


def _may_instance(thing):
    if thing.is_instancer or thing.instance_type != "NONE":
        return True
    return any(modifier.type in {"NODES", "PARTICLE_SYSTEM"} for modifier in thing.modifiers)


def _turned(matrix):
    """Whether a box along the object's axes is not one along the world's."""
    largest = max(abs(matrix[row][column]) for row in range(3) for column in range(3))
    limit = 1e-6 * largest if math.isfinite(largest) else 0.0
    return any(sum(abs(matrix[row][column]) > limit for column in range(3)) > 1 for row in range(3))


def _moved(matrix, low, high, rough=False):
    """The box around a box that ``matrix`` has moved."""
    middle, half = (low + high) / 2, (high - low) / 2
    centre = matrix @ middle
    reach = [sum(abs(matrix[row][column]) * half[column] for column in range(3)) for row in range(3)]
    return Box((centre[i] - reach[i] for i in range(3)), (centre[i] + reach[i] for i in range(3)), rough)


def evaluated_graph():
    """The evaluated scene at its current frame; evaluates only what has changed since the last time."""
    return bpy.context.evaluated_depsgraph_get()
