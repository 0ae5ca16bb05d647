# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of an actor's objects at the current frame: one set of triangles, and loose points, in metres.

It holds evaluated meshes, curves and texts as meshes, instances, the surfaces of liquids, and particles as points. For
closed pieces of mesh it knows which side is inside, whichever way their normals point.
"""

import hashlib
from functools import cached_property
from itertools import islice

import bpy
import numpy
from mathutils.bvhtree import BVHTree

from .json_values import called

MOST_TRIANGLES = 400_000  # of one actor; further objects become boxes
MOST_WITH_BOXES = 600_000
MOST_INSTANCES = 20_000
MOST_POINTS = 20_000
SEEDS = 200
_INSET = 0.003  # of the way to the middle
_CONVERTED = {"CURVE", "SURFACE", "FONT", "META"}
_BOXED = {"VOLUME", "POINTCLOUD", "CURVES", "GREASEPENCIL"}
_SMALLEST_VOLUME = 1e-12
_FARTHEST = 1e9  # metres; corners further away, or not finite, are ignored
_FACES = "013032467475045051237276026064157173"
_BOX = numpy.array([int(corner) for corner in _FACES]).reshape(-1, 3)
_LOOKING_OUT = numpy.ones(len(_BOX), dtype=numpy.int8)
# Steps of a sequence that fills a square evenly (powers of the plastic number's inverse): the same seeds on every run.
_STEPS = numpy.array([0.7548776662466927, 0.5698402909980532])


class ActorSurface:
    """Triangles: ``corners`` (c, 3) and ``faces`` (n, 3), their indices; ``points`` (m, 3): loose points.

    ``sides`` (n): 1 where a triangle's normal points out of a solid, -1 into one, 0 on a sheet. ``low`` and ``high``
    are the corners of its bounds.
    """

    def __init__(self, corners, faces, sides, points):
        self.corners, self.faces, self.sides, self.points = corners, faces, sides, points
        everything = numpy.concatenate([corners, points])
        self.empty = not len(everything)
        if not self.empty:
            self.low, self.high = everything.min(axis=0), everything.max(axis=0)

    @cached_property
    def tree(self):
        """Its triangles as a BVH tree; None without triangles."""
        if not len(self.faces):
            return None
        return BVHTree.FromPolygons(self.corners.tolist(), self.faces.tolist(), all_triangles=True)

    @cached_property
    def triangles(self):
        """Corners of each triangle: three arrays (n, 3)."""
        return tuple(self.corners[self.faces[:, place]] for place in range(3))

    @cached_property
    def boxes(self):
        """The corners of each triangle's bounds: two arrays (n, 3)."""
        first, second, third = self.triangles
        least = numpy.minimum(numpy.minimum(first, second), third)
        return least, numpy.maximum(numpy.maximum(first, second), third)

    @cached_property
    def seeds(self):
        """Points spread over it by area, its lowest and highest corners, and an even selection of loose points."""
        return numpy.concatenate([self._spread(), self._ends(), _even_selection(self.points)])

    def part(self, low, high):
        """Its triangles that reach into a box, with all of its points; None if there are none."""
        least, greatest = self.boxes
        kept = ((greatest >= low) & (least <= high)).all(axis=1)
        if not kept.any():
            return None
        used, faces = numpy.unique(self.faces[kept], return_inverse=True)
        return ActorSurface(self.corners[used], faces.reshape(-1, 3), self.sides[kept], self.points)

    def _spread(self):
        if not len(self.faces):
            return numpy.empty((0, 3))
        first, second, third = self.triangles
        areas = numpy.linalg.norm(numpy.cross(second - first, third - first), axis=1)
        reached = numpy.cumsum(areas)
        if reached[-1] <= 0:
            return first[:SEEDS]
        at = numpy.searchsorted(reached, (numpy.arange(SEEDS) + 0.5) / SEEDS * reached[-1])
        at = numpy.minimum(at, len(areas) - 1)
        both = (numpy.arange(1, SEEDS + 1)[:, None] * _STEPS) % 1.0
        folded = both.sum(axis=1) > 1
        both[folded] = 1 - both[folded]
        u, v = both[:, :1], both[:, 1:]
        return first[at] * (1 - u - v) + second[at] * u + third[at] * v

    def _ends(self):
        """The lowest and highest corners, moved slightly inwards so that vertical lines through them hit faces."""
        if not len(self.corners):
            return numpy.empty((0, 3))
        order = numpy.argsort(self.corners[:, 2].round(5), kind="stable")
        ends = self.corners[numpy.concatenate([order[:24], order[-8:]])]
        ends[:, :2] += (self.corners[:, :2].mean(axis=0) - ends[:, :2]) * _INSET
        return ends


def _even_selection(points):
    if len(points) <= SEEDS:
        return points
    return points[numpy.linspace(0, len(points) - 1, SEEDS).astype(int)]


class SurfaceBuilder:
    """Builds surfaces, and reuses those that are the same at another frame."""

    def __init__(self, scale):
        self._scale = scale
        self._objects = {}
        for obj in bpy.data.objects:
            self._objects.setdefault(called(obj), obj)
        self._pieces, self._surfaces, self._locals = {}, {}, {}

    def surfaces(self, groups, graph):
        """The surface of each group (tuple of object names) at the current frame of ``graph``."""
        self._locals.clear()
        wanted = {name for group in groups for name in group}
        parts = {name: [] for name in wanted}
        points = {name: [] for name in wanted}
        counts = dict.fromkeys(wanted, 0)
        for name in sorted(wanted & self._objects.keys()):
            self._add_own(self._objects[name], graph, parts[name], points[name], counts)
        self._add_instances(wanted, graph, parts, counts)
        return [self._surface(group, parts, points) for group in groups]

    def _surface(self, group, parts, points):
        pieces = [piece for name in group for piece in parts[name]]
        starts = numpy.cumsum([0, *(len(piece[0]) for piece in pieces)])
        corners = numpy.concatenate([numpy.empty((0, 3)), *(piece[0] for piece in pieces)]) * self._scale
        faces = [piece[1] + start for piece, start in zip(pieces, starts, strict=False)]
        faces = numpy.concatenate([numpy.empty((0, 3), dtype=int), *faces])
        sides = numpy.concatenate([numpy.empty(0, dtype=numpy.int8), *(piece[2] for piece in pieces)])
        loose = numpy.concatenate([numpy.empty((0, 3)), *(each for name in group for each in points[name])])
        loose = loose[(numpy.abs(loose) < _FARTHEST).all(axis=1)] * self._scale
        finite = (numpy.abs(corners) < _FARTHEST).all(axis=1)
        if not finite.all():
            kept = finite[faces].all(axis=1)
            used, faces = numpy.unique(faces[kept], return_inverse=True)
            corners, faces, sides = corners[used], faces.reshape(-1, 3), sides[kept]
        key = _digest(corners, faces, loose)
        if key not in self._surfaces:
            self._surfaces[key] = ActorSurface(corners, faces, sides, loose)
        return self._surfaces[key]

    def _add_own(self, obj, graph, parts, points, counts):
        """Adds an object's own geometry, and its particles."""
        evaluated = obj.evaluated_get(graph)
        matrix = numpy.array(evaluated.matrix_world, dtype=numpy.float64)
        if not _is_bare_domain(obj, evaluated):
            self._add(called(obj), evaluated, matrix, parts, counts)
        for system in evaluated.particle_systems:
            particles = _live_particles(system)
            if len(particles):
                points.append(particles)

    def _add_instances(self, wanted, graph, parts, counts):
        """Adds the instances that the wanted objects show."""
        if not any(_is_instancer(self._objects[name]) for name in wanted & self._objects.keys()):
            return
        for instance in islice(graph.object_instances, MOST_INSTANCES):
            if not instance.is_instance or instance.parent is None:
                continue
            name = called(instance.parent.original)
            if name in wanted and not _is_particle(instance):
                matrix = numpy.array(instance.matrix_world, dtype=numpy.float64)
                self._add(name, instance.object, matrix, parts[name], counts)

    def _add(self, name, evaluated, matrix, parts, counts):
        key = evaluated.data.as_pointer() if evaluated.data is not None else None
        if key not in self._locals:
            self._locals[key] = self._local(evaluated)
        local = self._locals[key]
        if local is None or counts[name] >= MOST_WITH_BOXES:
            return
        if counts[name] + len(local[1]) > MOST_TRIANGLES:
            local = _box(evaluated)
        corners, faces, sides = local
        counts[name] += len(faces)
        corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
        turned = numpy.linalg.det(matrix[:3, :3]) < 0
        parts.append((corners, faces, -sides if turned else sides))

    def _local(self, evaluated):
        """(corners, triangles, sides) in the object's own space; None if it has no surface."""
        data = evaluated.data
        if isinstance(data, bpy.types.Mesh):
            return self._of_mesh(data)
        if evaluated.type in _CONVERTED:
            mesh = evaluated.to_mesh()
            local = self._of_mesh(mesh) if mesh is not None else None
            evaluated.to_mesh_clear()
            return local
        return _box(evaluated) if evaluated.type in _BOXED else None

    def _of_mesh(self, mesh):
        if len(mesh.polygons) == 0:
            return None
        mesh.calc_loop_triangles()
        faces = numpy.empty(3 * len(mesh.loop_triangles), dtype=numpy.int32)
        mesh.loop_triangles.foreach_get("vertices", faces)
        flat = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
        mesh.vertices.foreach_get("co", flat)
        faces, corners = faces.reshape(-1, 3), flat.reshape(-1, 3).astype(numpy.float64)
        key = _digest(faces)
        if key not in self._pieces:
            self._pieces[key] = pieces_of(len(corners), faces)
        return corners, faces, sides_of(corners, faces, *self._pieces[key])


def sides_of(corners, faces, pieces, closed):
    """Per triangle: 1 if its normal points out of its closed piece, -1 if into it, 0 if the piece is open."""
    first, second, third = (corners[faces[:, place]] for place in range(3))
    parts = (first * numpy.cross(second, third)).sum(axis=1)
    volumes = numpy.where(closed, numpy.bincount(pieces, parts, len(closed)), 0.0)
    # Far from the origin, the terms of a flat piece's volume do not cancel exactly.
    least = max(_SMALLEST_VOLUME, 1e-12 * float(numpy.abs(corners).max()) ** 3)
    volumes[numpy.abs(volumes) <= least] = 0
    return numpy.sign(volumes[pieces]).astype(numpy.int8)


def pieces_of(count, faces):
    """(per triangle the connected piece it belongs to, per piece whether each of its edges has two triangles)."""
    labels = numpy.arange(count)
    first, second, third = faces.T
    while True:
        before = labels
        least = numpy.minimum(numpy.minimum(labels[first], labels[second]), labels[third])
        labels = labels.copy()
        for place in (first, second, third):
            numpy.minimum.at(labels, place, least)
        labels = labels[labels]
        if numpy.array_equal(labels, before):
            break
    pieces = labels[first]
    ends = numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(numpy.int64)
    edges = numpy.minimum(ends[:, 0], ends[:, 1]) * count + numpy.maximum(ends[:, 0], ends[:, 1])
    _, back, uses = numpy.unique(edges, return_inverse=True, return_counts=True)
    closed = numpy.ones(count, dtype=bool)
    closed[numpy.tile(pieces, 3)[uses[back.reshape(-1)] != 2]] = False
    return pieces, closed


def _digest(*arrays):
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(numpy.ascontiguousarray(array).data)
        digest.update(repr(array.shape).encode())
    return digest.digest()


def _box(evaluated):
    corners = numpy.array([tuple(corner) for corner in evaluated.bound_box], dtype=numpy.float64)
    # Blender lists the corners around each end; here they are ordered by their bits x, y, z.
    corners = corners[[0, 1, 3, 2, 4, 5, 7, 6]]
    return corners, _BOX, _LOOKING_OUT


def _is_bare_domain(obj, evaluated):
    """Whether it is a liquid's domain that shows its box instead of the liquid."""
    domains = [each for each in obj.modifiers if each.type == "FLUID" and each.fluid_type == "DOMAIN"]
    liquid = any(each.domain_settings and each.domain_settings.domain_type == "LIQUID" for each in domains)
    return liquid and len(evaluated.data.vertices) == len(obj.data.vertices)


def _is_instancer(obj):
    nodes = any(modifier.type == "NODES" for modifier in obj.modifiers)
    return obj.is_instancer or obj.instance_type != "NONE" or nodes


def _is_particle(instance):
    """Whether an instance shows a particle: particles count as points."""
    return instance.particle_system is not None


def _live_particles(system):
    """The positions of live particles; none for hair."""
    settings = system.settings
    if settings is None or settings.type == "HAIR" or not len(system.particles):
        return numpy.empty((0, 3))
    step = max(1, len(system.particles) // MOST_POINTS)
    chosen = islice(system.particles, 0, None, step)
    locations = [tuple(each.location) for each in chosen if each.alive_state == "ALIVE"]
    return numpy.array(locations, dtype=numpy.float64).reshape(-1, 3)
