# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what the scene's camera sees of an object (see agents.protocol.measures.motion)."""

import bpy
import numpy
from mathutils import Vector

from ..blend.fluids import domain_of, is_empty_domain
from ..blend.see_through import is_see_through
from ..blend.visibility import rendered_objects
from ..geometry.solids import Unmeasurable
from ..motion.mesh_tracker import surface_points
from .movement import actor_of

_SAMPLES = 1000
_MOST_OUTLINE = 20_000  # places that an outline is drawn around
_MOST_PASSED = 64  # transparent surfaces that a ray passes at most


def camera_view(request, solids):
    """The share of objects inside the picture, how much of the picture they cover, and what hides them."""
    scene, graph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    camera = scene.camera
    if camera is None:
        raise Unmeasurable("the scene has no active camera")
    if camera.data.type == "PANO":
        raise Unmeasurable("the camera is panoramic")
    samples, outline = _places(request["names"], solids, graph)
    if samples is None:
        return {}
    projection = _projection(scene, camera, graph)
    flat = _projected(projection, samples)
    inside = (numpy.abs(flat[:, :3]) <= flat[:, 3:]).all(axis=1) & (flat[:, 3] > 0)
    result = {"inside": float(inside.mean()), "cover": _covered_share(_projected(projection, outline))}
    result["at"] = samples.mean(axis=0).tolist()
    if inside.any():
        result.update(
            _hidden(scene, graph, camera.evaluated_get(graph), samples[inside], (request["names"], solids))
        )
    return result


def _places(names, solids, graph):
    """(points on surfaces, particles and fluids; points for the outline); (None, None) if nothing exists."""
    samples, outline, surfaces = [], [], []
    for name in names:
        actor = actor_of((name,))
        if actor.measured in {"particles", "fluid"}:
            state = actor.state_at(graph)
            points = [] if state is None else [tuple(place) for place in state.sample(_SAMPLES)]
            samples.append(numpy.array(points).reshape(-1, 3))
            outline.append(samples[-1])
        if actor.measured == "vertices" or (actor.measured == "particles" and _is_shown(actor.objects[0])):
            surfaces.append(name)
    if surfaces or not samples:
        solid = solids.joined(surfaces or names)
        samples.append(surface_points(solid, _SAMPLES))
        outline.append(solid.points)
        if not len(samples[-1]):
            raise Unmeasurable("its faces have no area")
    samples, outline = numpy.concatenate(samples), numpy.concatenate(outline)
    return (samples, outline[:: -(-len(outline) // _MOST_OUTLINE)]) if len(samples) else (None, None)


def _is_shown(emitter):
    """Whether the mesh that particles come out of is rendered itself."""
    return not emitter.hide_render and emitter.show_instancer_for_render


def _projection(scene, camera, graph):
    render = scene.render
    matrix = camera.evaluated_get(graph).calc_matrix_camera(
        graph,
        x=render.resolution_x,
        y=render.resolution_y,
        scale_x=render.pixel_aspect_x,
        scale_y=render.pixel_aspect_y,
    )
    return numpy.array(matrix @ camera.evaluated_get(graph).matrix_world.normalized().inverted_safe(), float)


def _projected(projection, places):
    """Points in homogeneous picture coordinates (n × 4): the picture reaches from −w to w."""
    return places @ projection[:, :3].T + projection[:, 3]


# Size in the picture


def _covered_share(flat):
    """The share of the picture inside the convex outline of projected points."""
    ahead = flat[flat[:, 3] > 1e-6]
    if len(ahead) < 3:
        return 0.0
    outline = _clipped(_hull(ahead[:, :2] / ahead[:, 3:]))
    if len(outline) < 3:
        return 0.0
    x, y = numpy.array(outline).T
    return float(abs(numpy.dot(x, numpy.roll(y, -1)) - numpy.dot(y, numpy.roll(x, -1))) / 2 / 4)


def _hull(points):
    """The convex outline of points in a plane, counter-clockwise."""
    points = numpy.unique(points, axis=0).tolist()
    halves = []
    for line in (points, points[::-1]):
        half = []
        for point in line:
            while len(half) > 1 and _orientation(half[-2], half[-1], point) <= 0:
                half.pop()
            half.append(point)
        halves += half[:-1]
    return halves


def _orientation(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _clipped(outline):
    """The part of a convex outline that is inside the picture."""
    for axis, side in ((0, -1), (0, 1), (1, -1), (1, 1)):
        kept = []
        for a, b in zip(outline, [*outline[1:], *outline[:1]], strict=True):
            over_a, over_b = side * a[axis] - 1, side * b[axis] - 1
            if over_a <= 0:
                kept.append(a)
            if (over_a < 0 < over_b) or (over_b < 0 < over_a):
                share = over_a / (over_a - over_b)
                kept.append([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])])
        outline = kept
    return outline


# Occlusion


def _hidden(scene, graph, camera, samples, subject):
    """The share of samples that other objects hide, and the names of up to three of these, the worst first."""
    matrix = camera.matrix_world.normalized()
    eye, towards = matrix.translation, -matrix.col[2].to_3d()
    count, by = 0, {}
    rays = _Rays(scene, graph, subject)
    for place in map(Vector, samples.tolist()):
        start = place - towards * (place - eye).dot(towards) if camera.data.type == "ORTHO" else eye
        start = start + (place - start).normalized() * camera.data.clip_start
        if name := rays.stopped_by(start, place):
            count += 1
            by[name] = by.get(name, 0) + 1
    return {"hidden": count / len(samples), "by": sorted(by, key=by.get, reverse=True)[:3]}  # pyright: ignore[reportCallIssue]


class _Rays:
    """Rays from the camera, which stop at what is rendered, opaque, and not the subject itself."""

    def __init__(self, scene, graph, subject):
        self._scene, self._graph = scene, graph
        self._names = set(subject[0])
        self._own = [solid for name in subject[0] if (solid := _solid(subject[1], name)) is not None]
        self._rendered = {obj.name for obj in rendered_objects(bpy.context.view_layer.layer_collection)}
        self._clear = {}

    def stopped_by(self, start, place):
        """The name of the first object between two points that hides the second; "" for none."""
        way = place - start
        step = max(way.length * 1e-5, 1e-5)
        for _ in range(_MOST_PASSED):
            left = (place - start).length - step
            if left <= 0:
                break
            hit, at, _, _, obj, _ = self._scene.ray_cast(self._graph, start, way.normalized(), distance=left)
            if not hit:
                break
            if self._stops(obj, at, step):
                return obj.name
            start = at + way.normalized() * step
        return ""

    def _stops(self, obj, at, step):
        obj = obj.original
        if obj.name in self._names or self._is_clear(obj):
            return False
        # An instance has the name of its original, so it may be a part of the subject.
        return not any(solid.tree.find_nearest(at, 2 * step)[0] is not None for solid in self._own)

    def _is_clear(self, obj):
        if obj.name not in self._clear:
            self._clear[obj.name] = (
                (obj.name in bpy.context.view_layer.objects and obj.name not in self._rendered)
                or not getattr(obj, "visible_camera", True)
                or self._is_box_of_fluid(obj)
                or is_see_through(obj)
            )
        return self._clear[obj.name]

    def _is_box_of_fluid(self, obj):
        """Whether it is a domain without a liquid's surface, of which renders show no more than a gas."""
        domain = domain_of(obj)
        return domain is not None and (
            domain.domain_type == "GAS" or is_empty_domain(obj.evaluated_get(self._graph))
        )


def _solid(solids, name):
    try:
        return solids[name]
    except Unmeasurable:
        return None
