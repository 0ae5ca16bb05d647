# SPDX-License-Identifier: GPL-3.0-or-later
"""Where objects are at the start, the middle and the end of the clip, as played from keys and baked caches.

Unbaked physics is not simulated: it is switched off first (the file is not saved), and the objects that it would move
are read at the start only.
"""

from itertools import islice

import bpy
import numpy
from mathutils import Vector

from .json_values import called, number, vector

MOST_VERTICES = 500_000  # of one mesh whose bounds are taken from its corners
MOST_INSTANCES = 20_000
_WITHOUT_EXTENT = {"CAMERA", "LIGHT", "SPEAKER", "LIGHT_PROBE", "ARMATURE"}
_HELD = 0.5  # least share of its frames that a cache must hold to count as a bake, whatever it is marked as


class UnbakedPhysics:
    """Unbaked physics: a label in words, the objects that it moves, and the setting that turns it off."""

    def __init__(self, label, objects, holder, switch):
        self.label, self.objects = label, objects
        self._holder, self._switch = holder, switch

    def switch_off(self):
        """Turns its simulation off."""
        setattr(self._holder, self._switch, False)


def metres(scene):
    """Metres per unit of the scene."""
    units = scene.unit_settings
    return 1.0 if units.system == "NONE" else units.scale_length


def frames_of(scene):
    """The first, middle and last frame of the clip."""
    first, last = scene.frame_start, scene.frame_end
    return first, (first + last) // 2, last


def play(scene, facts_by_object, unbaked):
    """Adds ``moments`` to each of ``told`` ({object: its facts}). Yields the dependency graph at each sample frame."""
    unplayed = set()
    for physics in unbaked:
        physics.switch_off()
        unplayed.update(physics.objects)
    _show_all(facts_by_object)
    for turn, frame in enumerate(frames_of(scene)):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        instances = _instanced(graph, facts_by_object)
        scale = metres(scene)
        for obj, facts in facts_by_object.items():
            if facts["in_scene"] and (turn == 0 or obj not in unplayed):
                facts["moments"].append(_moment(obj, frame, graph, instances.get(called(obj)), scale))
        yield graph


def _show_all(facts_by_object):
    """Makes the viewport evaluate what a render shows."""
    for layer in _layers(bpy.context.view_layer.layer_collection):
        layer.hide_viewport = layer.collection.hide_viewport = False
    for obj, facts in facts_by_object.items():
        if facts["renders"]:
            obj.hide_viewport = False
            try:
                obj.hide_set(False)
            except RuntimeError:
                continue  # it is not in this view layer


def _layers(layer):
    yield layer
    for below in layer.children:
        yield from _layers(below)


def unbaked_of(scene, facts_by_object):
    """The physics of a scene that is not baked. ``told``: {object: its facts}."""
    unbaked = []
    world = scene.rigidbody_world
    if world is not None and world.enabled and world.point_cache is not None:
        bodies = [obj for obj in facts_by_object if _falls(obj, world)]
        if bodies and not world.point_cache.is_baked:
            unbaked.append(UnbakedPhysics("rigid-body world", bodies, world, "enabled"))
    for obj, facts in facts_by_object.items():
        for modifier, modifier_facts in zip(obj.modifiers, facts["modifiers"], strict=True):
            if modifier.show_viewport and (what := _unbaked(modifier, modifier_facts)):
                unbaked.append(UnbakedPhysics(f"{what} of {called(obj)}", [obj], modifier, "show_viewport"))
    return unbaked


def _falls(obj, world):
    body = obj.rigid_body
    return body is not None and body.type == "ACTIVE" and world.collection in obj.users_collection


def _unbaked(modifier, modifier_facts):
    """What a modifier would have to simulate, in words; "" for nothing."""
    for key, word in (("cloth", "cloth"), ("soft", "soft body"), ("particles", "particles")):
        cache = (modifier_facts.get(key) or {}).get("cache")
        if cache is not None and (not cache["is_baked"] or cache["frames"] < _HELD * cache["expected"]):
            return word
    domain = (modifier_facts.get("fluid") or {}).get("domain")
    if domain is not None:
        cache = domain["cache"]
        first, last = cache["range"]
        data = next((part for part in cache["parts"] if part["name"] == "data"), None)
        if data is None or data["frames"] < last - first + 1:
            return "fluid"
    if modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings is not None:
        surfaces = modifier.canvas_settings.canvas_surfaces
        if any(surface.is_cache_user and not surface.point_cache.is_baked for surface in surfaces):
            return "dynamic paint"
    return ""


# One object at one frame


def _moment(obj, frame, graph, instanced, scale):
    evaluated = obj.evaluated_get(graph)
    matrix = evaluated.matrix_world
    corners = instanced if instanced is not None else _corners(evaluated)
    row = {"frame": frame, "low": None, "high": None}
    if corners is not None and len(corners) and numpy.isfinite(corners).all():
        row["low"] = vector(corners.min(axis=0), scale)
        row["high"] = vector(corners.max(axis=0), scale)
    row["location"] = vector(matrix.translation, scale)
    try:
        row["rotation"] = vector(matrix.to_quaternion())
    except ValueError:
        row["rotation"] = [1.0, 0.0, 0.0, 0.0]
    return row


def _corners(evaluated):
    """Points in world space whose bounds are the object's; None if it has no extent."""
    matrix = numpy.array(evaluated.matrix_world, dtype=numpy.float64)
    data = evaluated.data
    if isinstance(data, bpy.types.Mesh) and 0 < len(data.vertices) <= MOST_VERTICES:
        flat = numpy.empty(3 * len(data.vertices), dtype=numpy.float32)
        data.vertices.foreach_get("co", flat)
        points = flat.reshape(-1, 3)
    elif data is None or evaluated.type in _WITHOUT_EXTENT or not len(getattr(data, "vertices", "?")):
        return None
    else:
        points = numpy.array([tuple(corner) for corner in evaluated.bound_box], dtype=numpy.float64)
    return points.astype(numpy.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def _instanced(graph, facts_by_object):
    """{name of an object that shows a collection: corners of the bounds of what it shows}."""
    wanted = {called(obj) for obj, facts in facts_by_object.items() if facts["instances"] is not None}
    corners_of = {}
    if not wanted:
        return corners_of
    for instance in islice(graph.object_instances, MOST_INSTANCES):
        if not instance.is_instance or instance.parent is None:
            continue
        name = called(instance.parent.original)
        if name in wanted and instance.object.type in {"MESH", "CURVE", "SURFACE", "FONT", "META", "VOLUME"}:
            matrix = instance.matrix_world
            corners_of.setdefault(name, []).extend(
                matrix @ Vector(corner) for corner in instance.object.bound_box
            )
    return {name: numpy.array([tuple(corner) for corner in corners]) for name, corners in corners_of.items()}


def surface_of(obj, graph):
    """(vertices, faces) of an object: those of its evaluated mesh or of its own data, whichever are more."""
    data = obj.evaluated_get(graph).data
    counts = [0, 0]
    for mesh in (data, obj.data):
        if isinstance(mesh, bpy.types.Mesh):
            counts = [max(counts[0], len(mesh.vertices)), max(counts[1], len(mesh.polygons))]
    if obj.type in {"CURVE", "SURFACE", "FONT", "META"}:
        evaluated = obj.evaluated_get(graph)
        mesh = evaluated.to_mesh()
        if mesh is not None:
            counts = [len(mesh.vertices), len(mesh.polygons)]
            evaluated.to_mesh_clear()
    return counts


def rate(scene):
    """Frames per second."""
    return number(scene.render.fps / scene.render.fps_base)
