# SPDX-License-Identifier: GPL-3.0-or-later
"""What actors touch while they move, from the gaps between evaluated surfaces at each frame."""

import itertools
import math

import bpy
import numpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..blend.fluids import domain_of, is_empty_domain
from ..blend.protocol_tags import object_collections
from ..blend.visibility import comes_and_goes
from ..geometry.evaluated_meshes import coordinates, transformed
from .actors import round_to

MOST_POLYGONS = 100_000  # of a surface that is measured
_POINTS = 200  # of a surface, from which distances to another one are measured
_SEEDS, _ROUNDS, _NEIGHBOURS = 4, 24, 40
_FREE_FALLS = 3.0  # a change of speed of this many times what gravity does in a frame is a blow
_BLOW = 0.5  # m/s; a smaller change is not a blow
_TIMES = 50  # periods of one contact that are listed


class TrackedSurface:
    """An object's evaluated mesh over many frames. Its BVH tree is kept as long as the mesh does not change."""

    def __init__(self, obj):
        self.obj = obj
        self.slack = _slack(obj)
        self.exists = False
        self.matrix = None
        self._comes_and_goes = comes_and_goes(obj)
        self._is_rigid = not obj.modifiers and getattr(obj.data, "shape_keys", None) is None
        self._places = self._tree = self._local = None

    @property
    def is_gone(self):
        """Whether keys have taken it out of renders by now, and it is no collider either."""
        return self._comes_and_goes and self.obj.hide_render and not _collides(self.obj)

    def update(self, graph):
        """Updates it from an evaluated dependency graph; its vertices only when they are needed."""
        evaluated = self.obj.evaluated_get(graph)
        self._now = evaluated, graph
        if self._is_rigid and self.matrix == evaluated.matrix_world:
            return
        mesh = evaluated.data
        self.matrix = evaluated.matrix_world.copy()
        self.exists = (
            0 < len(mesh.polygons) <= MOST_POLYGONS
            and not is_empty_domain(evaluated)
            and all(math.isfinite(part) for row in self.matrix for part in row)
        )
        if self.exists:
            self._fresh = False
            corners = transformed(numpy.array(evaluated.bound_box), self.matrix)
            self.low, self.high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()

    def is_near(self, low, high, reach):
        """Whether its box comes within ``reach`` of another one."""
        return all(
            low[axis] - reach <= self.high[axis] and high[axis] + reach >= self.low[axis] for axis in range(3)
        )

    def _refresh(self):
        if self._fresh:
            return
        self._fresh = True
        places = coordinates(self._now[0].data.vertices)
        if not numpy.array_equal(places, self._places):
            self._places, self._tree = places, None
            self._local = list(_spread(self._now[0].data, places))
            box = self._now[0].bound_box
            self._step = 2 * math.dist(box[0], box[6]) / math.sqrt(len(self._local))

    def points(self):
        """(points all over it, in the world; how far any point of it is at most from one of them)."""
        self._refresh()
        return [self.matrix @ point for point in self._local], self._step * max(
            map(abs, self.matrix.to_scale())
        )

    def _find(self, search, point, within):
        self._refresh()
        if self._tree is None:
            self._tree = BVHTree.FromObject(*self._now)
        scale = min(map(abs, self.matrix.to_scale()))
        return getattr(self._tree, search)(self.matrix.inverted_safe() @ point, within / max(scale, 1e-9))

    def nearest(self, point, within):
        """Its nearest place to a point of the world; None if that is farther than ``within``."""
        if not self.is_near(point, point, within):
            return None
        place = self._find("find_nearest", point, within)[0]
        return None if place is None else self.matrix @ place

    def corners_near(self, point, within):
        """The vertices of its polygons within a distance of a point, in the world."""
        mesh = self._now[0].data
        polygons = self._find("find_nearest_range", point, within)[:_NEIGHBOURS]
        numbers = {at for _, _, polygon, _ in polygons for at in mesh.polygons[polygon].vertices}
        return [self.matrix @ mesh.vertices[at].co for at in sorted(numbers)]


def _spread(mesh, places):
    """Points all over a surface: its vertices and, if these are few, points on its triangles."""
    yield from map(Vector, places[:: math.ceil(len(places) / _POINTS)].tolist())
    if len(places) >= _POINTS:
        return
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    whole = sum(triangle.area for triangle in triangles) or 1.0
    for triangle in triangles:
        a, b, c = (Vector(places[at]) for at in triangle.vertices)
        rows = max(1, round(math.sqrt(2 * _POINTS * triangle.area / whole)))
        for i in range(rows):
            for j in range(rows - i):
                u, v = (i + 1 / 3) / rows, (j + 1 / 3) / rows
                yield a + (b - a) * u + (c - a) * v


def _slack(obj):
    """The distance from a surface at which its collisions begin, in metres."""
    slack = 0.0
    body = obj.rigid_body
    if body is not None and (body.use_margin or body.collision_shape == "MESH"):
        slack = body.collision_margin
    for modifier in obj.modifiers:
        if modifier.type == "CLOTH":
            slack = max(slack, modifier.collision_settings.distance_min)
        elif modifier.type == "COLLISION":
            slack = max(slack, modifier.settings.thickness_outer)
    return slack


class Contacts:
    """Measures the gaps between actors and everything else that has a surface."""

    def __init__(self, scene, actors):
        self._blow = max(
            _BLOW, _FREE_FALLS * scene.gravity.length / (scene.render.fps / scene.render.fps_base)
        )
        self._surfaces = {}
        self._own = [self._own_surfaces(actor) for actor in actors]
        owners = {
            obj.name: collection.name
            for collection in object_collections(scene)
            for obj in collection.all_objects
        }
        touchable = [obj for obj in bpy.context.view_layer.objects if _is_touchable(obj)]
        self._others = []
        for actor in actors:
            own = {obj.name for obj in actor.objects}
            same = {owners.get(name) for name in own}
            self._others.append(
                [
                    (_name_to_report(obj, owners.get(obj.name), same), self._surface(obj))
                    for obj in touchable
                    if obj.name not in own
                ]
            )
        self._gaps = [{} for _ in actors]  # per actor: {name: {frame: (gap, tolerance)}}

    def _own_surfaces(self, actor):
        if actor.measured in {"particles", "origin"}:
            return []
        return [self._surface(obj) for obj in actor.objects if obj.type == "MESH"]

    def _surface(self, obj):
        return self._surfaces.setdefault(obj.name, TrackedSurface(obj))

    def look(self, frame, graph, tracks):
        """Measures the gaps at a frame that the ``tracks`` have measured already."""
        for surface in self._surfaces.values():
            surface.update(graph)
        for track, own, others, gaps in zip(tracks, self._own, self._others, self._gaps, strict=True):
            state = track.last
            if state is None:
                continue
            small = math.dist(state.low, state.high)
            for name, other in others:
                if not other.exists or other.is_gone:
                    continue
                size = (
                    min(small, math.dist(other.low, other.high))
                    if small
                    else math.dist(other.low, other.high)
                )
                reach = min(max(0.002, 0.005 * size), 0.01) + other.slack
                reach += max([surface.slack for surface in own], default=0.0)
                if not other.is_near(state.low, state.high, reach + track.moved):
                    continue
                gap = _gap(own, other, state, reach + track.moved)
                if gap < gaps.setdefault(name, {}).get(frame, (math.inf, 0))[0]:
                    gaps[name][frame] = gap, reach

    def summary(self, number, track, start, end):
        """What actor ``number`` touches from frame ``start`` to ``end``.

        A list of ``with`` (a name), ``frames`` ([first, last] of each time) and ``gap`` (metres, at the first frame).
        It touches what is nearer than the tolerance (2 mm to 1 cm by size, plus collision margins), or what is nearest
        when its velocity changes as by a blow: then it was hit between this frame and the next.
        """
        contacts = []
        for name, frames in self._gaps[number].items():
            touching = [
                frame
                for frame, (gap, reach) in frames.items()
                if start <= frame <= end and (gap <= reach or self._hits(number, track, name, frame))
            ]
            if touching:
                gap = round_to(frames[touching[0]][0])
                contacts.append(
                    {"with": name, "frames": _frame_runs(touching, track.frames)[:_TIMES], "gap": gap}
                )
        return sorted(contacts, key=lambda contact: (contact["frames"], contact["gap"]))

    def _hits(self, number, track, name, frame):
        if track.changes_by(frame) < self._blow:
            return False
        near = {other: frames[frame][0] for other, frames in self._gaps[number].items() if frame in frames}
        return min(near, key=near.get) == name  # pyright: ignore[reportCallIssue]


def _frame_runs(touching, measured):
    """[first, last] of each unbroken run of frames, among those that were measured."""
    times, following = [], dict(itertools.pairwise(measured))
    for frame in touching:
        if times and following[times[-1][1]] == frame:
            times[-1][1] = frame
        else:
            times.append([frame, frame])
    return times


def _gap(own, other, state, reach):
    """The distance of an actor to a surface if it is within ``reach``, or infinite."""
    own = [surface for surface in own if surface.exists]
    if not own:
        places = [(point, other.nearest(point, reach)) for point in state.sample(_POINTS)]
        return min(((place - point).length for point, place in places if place is not None), default=math.inf)
    near = [surface for surface in own if other.is_near(surface.low, surface.high, reach)]
    nearest = min((surface_distance(surface, other, reach) for surface in near), default=math.inf)
    return nearest if nearest <= reach else math.inf


def surface_distance(a, b, reach):
    """The distance of two surfaces if it is within ``reach``, else infinite: the nearest of some points are projected
    to and fro between the surfaces until they settle."""
    seeds = []
    for surface, other in ((a, b), (b, a)):
        points, step = surface.points()
        for point in points:
            place = other.nearest(point, reach + step)
            if place is not None:
                seeds.append(((place - point).length, place, surface, other))
    seeds.sort(key=lambda seed: seed[0])
    return min((_settled_gap(*seed) for seed in seeds[:_SEEDS]), default=math.inf)


def _settled_gap(gap, place, surface, other):
    """The distance ``gap``, from ``place`` on ``other`` to ``surface``, shortened by going to and fro between them: to
    the nearest place, or to that of a vertex nearby."""
    for _ in range(_ROUNDS):
        within = gap * 1.001 + 1e-5
        feet = [surface.nearest(place, within), *surface.corners_near(place, within)]
        pairs = [(foot, other.nearest(foot, within)) for foot in feet if foot is not None]
        shorter, nearest = min(
            (((there - foot).length, there) for foot, there in pairs if there is not None),
            default=(gap, None),
            key=lambda pair: pair[0],
        )
        if gap - shorter < 1e-5:
            return min(gap, shorter)
        gap, place = shorter, nearest
    return gap


def _name_to_report(obj, owner, same):
    """The object collection that an object is in; its own name if there is none, or it is the actor's."""
    return obj.name if owner is None or owner in same else owner


def _is_touchable(obj):
    """Whether an object has a mesh that is visible or takes part in collisions."""
    if obj.type != "MESH" or not obj.visible_get():
        return False
    domain = domain_of(obj)
    return (_collides(obj) or not obj.hide_render) and (domain is None or domain.domain_type == "LIQUID")


def _collides(obj):
    return obj.rigid_body is not None or any(modifier.type == "COLLISION" for modifier in obj.modifiers)
