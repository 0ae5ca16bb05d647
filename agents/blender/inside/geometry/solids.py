# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated objects as triangles in the world, on which distances and depths are measured. Metres."""

import functools

import bpy
import numpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..blend.fluids import is_empty_domain
from .evaluated_meshes import Instances, TooManyInstances, TriangleMesh, are_finite, mesh_of
from .topology import grouped, piece_labels

MOST_TRIANGLES = 4_000_000
# Arbitrary directions: a ray along an edge or through a vertex would count twice.
_RAYS = tuple(
    Vector(ray).normalized()
    for ray in ((0.371, 0.604, 0.705), (-0.713, 0.181, 0.677), (0.253, -0.871, 0.421))
)
_STEP = 1e-5
_COARSE = 4e-7  # of a coordinate: smaller differences are lost in single precision
_MOST_HITS = 1000


class Unmeasurable(Exception):  # noqa: N818 - reads as the state it names
    """The measurement is impossible; the message says why."""


class NoSurface(Unmeasurable):
    """It exists, but has no faces at this frame."""


class NotNumbers(Unmeasurable):
    """It has coordinates that are not finite."""


class Solid:
    """The triangles of one object: ``points`` (n × 3, world), ``triangles`` (m × 3)."""

    def __init__(self, name, points, triangles):
        self.name = name
        self.points = points
        self.triangles = triangles
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        self.eye = None  # where the camera is
        self.topology = self.closed_parts = self.nudged = self.pieces = None  # caches of other modules

    @functools.cached_property
    def tree(self):
        """Its BVH tree."""
        return BVHTree.FromPolygons(self.points.tolist(), self.triangles.tolist(), all_triangles=True)

    @property
    def has_tree(self):
        """Whether its tree exists already."""
        return "tree" in vars(self)

    @functools.cached_property
    def boxes(self):
        """(low, high) corners of the boxes around its triangles."""
        a, b, c = (self.points[column] for column in self.triangles.T)
        return numpy.minimum(numpy.minimum(a, b), c), numpy.maximum(numpy.maximum(a, b), c)

    @functools.cached_property
    def welded(self):
        """(places, number of each point's place): equal points are at one place."""
        order = numpy.lexsort(self.points.T)
        ordered = self.points[order]
        first = numpy.ones(len(order), bool)
        first[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
        same = numpy.empty(len(order), int)
        same[order] = numpy.cumsum(first) - 1
        return ordered[first], same

    @functools.cached_property
    def corners(self):
        """The places of its triangles' corners (m × 3, numbers)."""
        return self.welded[1][self.triangles]

    @property
    def edges(self):
        """(edges as pairs of places, how many triangles each has)."""
        return self._edges[:2]

    @functools.cached_property
    def _edges(self):
        """(edges, numbers of triangles, how many more triangles go along it one way than the other)."""
        count = len(self.welded[0])
        pairs = numpy.concatenate([self.corners[:, sides] for sides in ((0, 1), (1, 2), (2, 0))])
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        low, high = pairs.min(axis=1), pairs.max(axis=1)
        keys, back, counts = numpy.unique(low * count + high, return_inverse=True, return_counts=True)
        ways = numpy.bincount(back, numpy.where(pairs[:, 0] == low, 1, -1), len(keys))
        return numpy.stack([keys // count, keys % count], axis=1), counts, ways

    @functools.cached_property
    def closed(self):
        """Whether every edge has an even number of triangles."""
        _, counts = self.edges
        return bool(len(counts)) and bool((counts % 2 == 0).all())

    @functools.cached_property
    def oriented(self):
        """Whether the normals are consistent, so that they show which side is inside."""
        return not self._edges[2].any()

    @property
    def hollow(self):
        """Whether a closed one is hollow: it is inside out, or the camera is in it."""
        corners = self.points[self.triangles] - self.points.mean(axis=0)
        volume = numpy.einsum("ij,ij->", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2]))
        if self.oriented and volume < 0:
            return True
        eye = self.eye
        return eye is not None and bool(((eye > self.low) & (eye < self.high)).all()) and self.holds(eye)

    @property
    def diagonal(self):
        """The length of its box's diagonal."""
        return float(numpy.linalg.norm(self.high - self.low))

    def holds(self, point):
        """Whether a point is inside it, by a majority of three rays. Only for a closed one."""
        shells = self._shells.around(point)
        first, second = (self._is_around(shells, point, ray) for ray in _RAYS[:2])
        return first if first == second else self._is_around(shells, point, _RAYS[2])

    def _is_around(self, shells, point, ray):
        count = sum(shell.crossings(point, ray, signed=self.oriented) for shell in shells)
        # Without consistent normals, only the number of hits counts.
        return count != 0 if self.oriented else count % 2 == 1

    @functools.cached_property
    def _shells(self):
        return _Shells(self)

    def crossings(self, point, ray, *, signed):
        """How often a ray goes through its surface: ``signed``, how much more often outwards than inwards."""
        count = hits = 0
        start = Vector(point)
        step = ray * max(_STEP, _COARSE * max(map(abs, point)))
        for _ in range(_MOST_HITS):
            place, normal, _, _ = self.tree.ray_cast(start, ray)
            if place is None:
                break
            hits += 1
            count += 1 if normal.dot(ray) > 0 else -1
            start = place + step
        return count if signed else hits

    def nearest(self, point, within=None):
        """(place, normal, triangle, distance) of the nearest point of its surface, Nones beyond ``within``."""
        return self.tree.find_nearest(point) if within is None else self.tree.find_nearest(point, within)

    def moved(self, step):
        """A copy of it, moved by ``step``."""
        copy = Solid(self.name, self.points + step, self.triangles)
        places, same = self.welded
        copy.eye, copy.welded = self.eye, (places + step, same)
        unchanged = ("corners", "_edges", "closed", "oriented")
        vars(copy).update({name: value for name, value in vars(self).items() if name in unchanged})
        if "boxes" in vars(self):
            copy.boxes = self.boxes[0] + step, self.boxes[1] + step
        if self.pieces is not None:
            copy.pieces = self.pieces[0], self.pieces[1] + step, self.pieces[2] + step
        return copy

    def part(self, chosen):
        """A solid of some of its triangles (a mask, or their numbers)."""
        triangles = self.triangles[chosen]
        used, numbers = numpy.unique(triangles, return_inverse=True)
        solid = Solid(self.name, self.points[used], numbers.reshape(-1, 3))
        solid.eye = self.eye
        return solid


class _Shells:
    """The closed pieces of a solid as they were modelled, each a solid, and last what is left of it.

    Where pieces touch, two faces coincide, of which a ray hits one: it has to be cast through each piece alone.
    """

    def __init__(self, solid):
        self._solid = solid
        label = piece_labels(len(solid.points), solid.triangles)[solid.triangles[:, 0]]
        known, pieces = numpy.unique(label, return_inverse=True)
        pieces = pieces.reshape(-1)
        pieces = numpy.where(self._is_open(len(known), pieces)[pieces], len(known), pieces)
        order, starts, self._low, self._high = grouped(pieces, solid.boxes)
        self._triangles = numpy.split(order, starts[1:])
        self._made = {0: solid} if len(starts) == 1 else {}

    def _is_open(self, count, pieces):
        """Whether each of ``count`` pieces has an edge with an odd number of triangles."""
        corners = self._solid.triangles
        ends = numpy.concatenate([corners[:, sides] for sides in ((0, 1), (1, 2), (2, 0))]).astype(
            numpy.int64
        )
        keys = ends.min(axis=1) * len(self._solid.points) + ends.max(axis=1)
        _, first, sides = numpy.unique(keys, return_index=True, return_counts=True)
        is_open = numpy.zeros(count, bool)
        is_open[numpy.tile(pieces, 3)[first[sides % 2 == 1]]] = True
        return is_open

    def around(self, point):
        """Those whose boxes hold a point."""
        inside = ((self._low <= point) & (self._high >= point)).all(axis=1)
        return [self._shell(number) for number in numpy.flatnonzero(inside).tolist()]

    def _shell(self, number):
        if number not in self._made:
            self._made[number] = self._solid.part(self._triangles[number])
        return self._made[number]


class Solids:
    """The solids of the evaluated scene at its current frame, made when needed."""

    def __init__(self):
        self._graph = bpy.context.evaluated_depsgraph_get()
        self._made = {}
        self._instances = Instances(self._graph)
        self._things = None
        camera = bpy.context.scene.camera
        self._eye = None
        if camera is not None:
            self._eye = numpy.array(camera.evaluated_get(self._graph).matrix_world.translation)

    def __getitem__(self, name):
        solid = self._made.get(name)
        if solid is None:
            try:
                solid = self._solid(name)
            except Unmeasurable as reason:
                solid = reason
            self._made[name] = solid
        if isinstance(solid, Unmeasurable):
            raise type(solid)(*solid.args)
        return solid

    def joined(self, names):
        """The solid that several objects form together."""
        if len(names) == 1:
            return self[names[0]]
        key = tuple(names)
        if key not in self._made:
            if not names:
                raise Unmeasurable("no object was named")
            self._made[key] = _merged(
                " + ".join(names), [(self[name].points, self[name].triangles) for name in names]
            )
        return self._made[key]

    def _solid(self, name):
        if self._things is None:
            self._things = {obj.name: obj for obj in bpy.context.scene.objects}
        obj = self._things.get(name)
        if obj is None:
            raise Unmeasurable(f"there is no object {name!r} in the scene")
        evaluated = obj.evaluated_get(self._graph)
        if not evaluated.is_evaluated:
            raise Unmeasurable(
                f"{name!r} is not evaluated: it, or its collection, is hidden from the viewport or excluded"
            )
        if is_empty_domain(evaluated):
            raise NoSurface(
                f"{name!r} is the box of a fluid's domain, without a liquid's surface at this frame"
            )
        shapes = [*self._instanced(obj)]
        with mesh_of(evaluated) as mesh:
            if mesh is not None and len(mesh.polygons):
                shapes.append((TriangleMesh(mesh), evaluated.matrix_world))
            count = sum(len(shape.triangles) for shape, _ in shapes)
            if count > MOST_TRIANGLES:
                raise Unmeasurable(f"{name!r} has {count} triangles, more than {MOST_TRIANGLES}")
            placed = [shape.placed(matrix) for shape, matrix in shapes]
        if not placed:
            raise NoSurface(f"{name!r} has no surface")
        if not all(are_finite(points) for points, _ in placed):
            raise NotNumbers(f"{name!r} has coordinates that are not finite")
        solid = _merged(name, placed)
        solid.eye = self._eye  # pyright: ignore[reportAttributeAccessIssue]
        return solid

    def _instanced(self, obj):
        """[(shape, matrix)] of the instances that an object makes."""
        try:
            return self._instances.of(obj)
        except TooManyInstances as reason:
            raise Unmeasurable(str(reason)) from None


# Pairs of triangles


_CHUNK = 20_000  # triangles that are tested at once if both solids have more


def crossing_pairs(a, b, most):
    """Pairs (n × 2) of triangles of two solids that cross or touch; of very many, about ``most``."""
    ours, theirs = _triangles_in_box(a, b), _triangles_in_box(b, a)
    if not len(ours) or not len(theirs):
        return numpy.empty((0, 2), int)
    theirs, other = _tree_of(b, theirs)
    if len(theirs) <= _CHUNK or len(ours) <= _CHUNK:
        ours, tree = _tree_of(a, ours)
        return _with_own_numbers(tree.overlap(other), ours, theirs)
    chunks, count = [], 0
    for start in range(0, len(ours), _CHUNK):
        some = ours[start : start + _CHUNK]
        chunks.append(_with_own_numbers(a.part(some).tree.overlap(other), some, theirs))
        count += len(chunks[-1])
        if count >= most:
            break
    return numpy.concatenate(chunks)


def _with_own_numbers(pairs, ours, theirs):
    pairs = numpy.array(pairs, int).reshape(-1, 2)
    return numpy.stack([ours[pairs[:, 0]], theirs[pairs[:, 1]]], axis=1)


def _triangles_in_box(solid, other):
    """The triangles of a solid whose boxes reach into that of another one."""
    low, high = solid.boxes
    # Axis by axis: a reduction over rows of three takes several times as long.
    meets = numpy.ones(len(low), bool)
    for axis in range(3):
        meets &= (low[:, axis] <= other.high[axis]) & (high[:, axis] >= other.low[axis])
    return numpy.nonzero(meets)[0]


def _tree_of(solid, chosen):
    """(numbers of the triangles in a tree, the tree): the solid's own, or one of the chosen triangles."""
    if solid.has_tree or 4 * len(chosen) > len(solid.triangles):
        return numpy.arange(len(solid.triangles)), solid.tree
    return chosen, solid.part(chosen).tree


def _merged(name, parts):
    """A solid of several (points, triangles)."""
    shifts = numpy.cumsum([0, *(len(points) for points, _ in parts)])
    return Solid(
        name,
        numpy.concatenate([points for points, _ in parts]),
        numpy.concatenate([triangles + shift for (_, triangles), shift in zip(parts, shifts, strict=False)]),
    )
