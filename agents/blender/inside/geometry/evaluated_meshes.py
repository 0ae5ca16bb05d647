# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes of objects and of the instances that they make. Changes nothing."""

import contextlib
import itertools

import numpy

from ..blend.visibility import rendered_objects

AS_MESH = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
MOST_INSTANCES = 50_000
_FARTHEST = 1e9  # metres; overflows in Blender become the largest float


class TooManyInstances(Exception):  # noqa: N818 - reads as the state it names
    """The scene has too many instances to read."""


class TriangleMesh:
    """A mesh in its own space: ``points`` (n × 3) and ``triangles`` (m × 3, numbers of points)."""

    def __init__(self, mesh):
        self.points = coordinates(mesh.vertices)
        mesh.calc_loop_triangles()
        numbers = numpy.empty(3 * len(mesh.loop_triangles), numpy.int32)
        mesh.loop_triangles.foreach_get("vertices", numbers)
        self.triangles = numbers.reshape(-1, 3)
        self.polygons = len(mesh.polygons)

    @property
    def corners(self):
        """The corners of its bounding box (8 × 3)."""
        return numpy.array(
            list(itertools.product(*zip(self.points.min(axis=0), self.points.max(axis=0), strict=True)))
        )

    def placed(self, matrix):
        """(points, triangles) transformed by ``matrix``; normals stay outwards if it mirrors."""
        points = transformed(self.points, matrix)
        mirrored = numpy.linalg.det(numpy.array(matrix, dtype=float)[:3, :3]) < 0
        return points, self.triangles[:, ::-1] if mirrored else self.triangles


def coordinates(elements, name="co"):
    """A vector property of all elements of a collection, as by default the places of vertices (n × 3)."""
    flat = numpy.empty(3 * len(elements), numpy.float32)
    elements.foreach_get(name, flat)
    return flat.reshape(-1, 3).astype(float)


def are_finite(points):
    """Whether coordinates are finite and not absurdly large."""
    return bool((numpy.abs(points) < _FARTHEST).all())


def transformed(points, matrix):
    """Points (n × 3) transformed by a 4 × 4 matrix."""
    turn = numpy.array(matrix, dtype=float)
    with numpy.errstate(all="ignore"):
        return points @ turn[:3, :3].T + turn[:3, 3]


@contextlib.contextmanager
def mesh_of(evaluated):
    """The mesh of an evaluated object, also in edit mode; None for one without vertices."""
    if evaluated.type not in AS_MESH:
        yield None
        return
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        mesh = None
    try:
        yield mesh if mesh is not None and len(mesh.vertices) else None
    finally:
        evaluated.to_mesh_clear()


def instances_of(graph):
    """{full name of what makes them: [(shape, matrix), …]} of all instances with faces, except of particles.

    Raises TooManyInstances.
    """
    by_place, shapes, count, meshes_of_others = {}, {}, 0, []
    if not any(map(may_instance, graph.objects)):
        return by_place
    for instance in graph.object_instances:
        if (
            not instance.is_instance
            or instance.object is None
            or instance.parent is None
            or instance.particle_system is not None
        ):
            continue
        obj, maker = instance.object, instance.parent.original
        if obj.type not in AS_MESH or obj.data is None:
            continue
        count += 1
        if count > MOST_INSTANCES:
            raise TooManyInstances(f"the scene has more than {MOST_INSTANCES} instances")
        matrix = instance.matrix_world.copy()
        if obj.original == maker and maker.type != "MESH" and matrix == instance.parent.matrix_world:
            continue  # the mesh of a text or curve itself, not an instance
        key = obj.data.as_pointer()
        if key not in shapes:
            with mesh_of(obj) as mesh:
                shapes[key] = TriangleMesh(mesh) if mesh is not None and len(mesh.polygons) else None
        if shapes[key] is None:
            continue
        # A text or curve comes twice: as itself, and as its mesh.
        place = maker.name_full, obj.original.name_full, tuple(value for row in matrix for value in row)
        if obj.type != "MESH":
            meshes_of_others.append((place, shapes[key], matrix))
            continue
        by_place.setdefault(place, []).append((shapes[key], matrix))
    for place, shape, matrix in meshes_of_others:
        by_place.setdefault(place, [(shape, matrix)])
    by_maker = {}
    for place, entries in by_place.items():
        by_maker.setdefault(place[0], []).extend(entries)
    return by_maker


class Instances:
    """The instances that the objects of a dependency graph make, read when first needed."""

    def __init__(self, graph):
        self._graph = graph
        self._found = None

    def of(self, obj):
        """[(shape, matrix)] of the instances that an object makes. Raises TooManyInstances."""
        if not may_instance(obj):
            return ()
        if self._found is None:
            try:
                self._found = instances_of(self._graph)
            except TooManyInstances as reason:
                self._found = reason
        if isinstance(self._found, TooManyInstances):
            raise TooManyInstances(*self._found.args)
        return self._found.get(obj.name_full, ())


def may_instance(obj):
    """Whether an object may make instances."""
    return obj.instance_type != "NONE" or any(modifier.type == "NODES" for modifier in obj.modifiers)


def rendered(scene):
    """The objects that renders of a scene show."""
    layers = [layer.layer_collection for layer in scene.view_layers if layer.use]
    return {obj for layer in layers for obj in rendered_objects(layer) if not _is_only_copied(obj)}


def _is_only_copied(obj):
    """Whether only its parent's instances of it are shown."""
    return obj.parent is not None and obj.parent.instance_type in {"VERTS", "FACES"}
