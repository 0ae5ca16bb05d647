# SPDX-License-Identifier: GPL-3.0-or-later
"""Rewrites the scene to centimetres: everything is a hundred times as large, the unit a hundredth of a metre.

What is baked stays baked, and shows the same: points in caches are multiplied where they lie; the rigid-body world,
whose cache cannot be taken out of the file, is baked anew with its bodies keyed along the paths that they took.
"""

import os

import bpy
import numpy
from mathutils import Matrix

from bench.audit.inside.channels import curves_of

from .point_cache_files import multiply

FACTOR = 100.0
_LENGTHS = ("location", "delta_location", "scale")


def rescale(actors):
    """Multiplies all lengths by 100, and divides the unit by 100. Returns the number of objects."""
    del actors
    scene = bpy.context.scene
    paths = _paths_of_bodies(scene)
    _multiply_caches(scene)
    for obj in scene.objects:
        _enlarge(obj)
    for action in {each for obj in scene.objects for each in _actions(obj)}:
        _enlarge_curves(action)
    scene.gravity = [FACTOR * each for each in scene.gravity]
    units = scene.unit_settings
    units.system = "METRIC"
    units.scale_length /= FACTOR
    _bake_bodies(scene, paths)
    return len(scene.objects)


def _enlarge(obj):
    """Enlarges an object; a child grows with its parent."""
    if obj.parent is None:
        obj.location *= FACTOR
        obj.delta_location *= FACTOR
        obj.scale *= FACTOR
    if obj.type == "CAMERA":
        obj.data.clip_start *= FACTOR
        obj.data.clip_end *= FACTOR


def _actions(obj):
    animated = obj.animation_data
    if obj.parent is None and animated is not None and animated.action is not None:
        yield animated.action, animated.action_slot


def _enlarge_curves(pair):
    action, slot = pair
    for curve in curves_of(action, slot):
        if curve.data_path in _LENGTHS:
            for point in curve.keyframe_points:
                for place in (point.co, point.handle_left, point.handle_right):
                    place.y *= FACTOR


# Caches of points


def _multiply_caches(scene):
    caches = [cache for obj in scene.objects for modifier in obj.modifiers if (cache := _cache_of(modifier))]
    for cache in caches:
        cache.use_disk_cache = True
    place, name = os.path.split(bpy.data.filepath)
    folder = os.path.join(place, f"blendcache_{os.path.splitext(name)[0]}")
    for file in sorted(os.listdir(folder)) if caches else ():
        multiply(os.path.join(folder, file), FACTOR)
    for cache in caches:
        cache.use_disk_cache = False
    for file in os.listdir(folder) if caches else ():
        os.unlink(os.path.join(folder, file))


def _cache_of(modifier):
    """The baked cache of a cloth, a soft body, or particles that have one."""
    if modifier.type in {"CLOTH", "SOFT_BODY"}:
        cache = modifier.point_cache
    elif modifier.type == "PARTICLE_SYSTEM":
        cache = modifier.particle_system.point_cache
    else:
        return None
    return cache if cache.is_baked and not cache.use_disk_cache else None


# Rigid bodies


def _paths_of_bodies(scene):
    """{name of an active body: its poses at every frame}; empty if the world is not baked."""
    world = scene.rigidbody_world
    if world is None or not world.point_cache.is_baked:
        return {}
    bodies = [obj for obj in world.collection.objects if obj.rigid_body.type == "ACTIVE"]
    paths = {obj.name: [] for obj in bodies}
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for obj in bodies:
            paths[obj.name].append(numpy.array(obj.evaluated_get(graph).matrix_world))
    scene.frame_set(scene.frame_start)
    return paths


def _bake_bodies(scene, paths):
    """Bakes the world with its bodies keyed, then restores them."""
    if not paths:
        return
    cache = scene.rigidbody_world.point_cache
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.free_bake()
    guided = [_GuidedBody(bpy.data.objects[name], scene.frame_start, poses) for name, poses in paths.items()]
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.bake(bake=True)
    for body in guided:
        body.release()


class _GuidedBody:
    """A body keyed to follow enlarged poses (4 × 4) from frame ``first`` on."""

    def __init__(self, obj, first, poses):
        animated = obj.animation_data
        self._obj, self._had_keys = obj, animated is not None and animated.action is not None
        self._keys = (animated.action, animated.action_slot) if self._had_keys else None
        self._kinematic, self._mode = obj.rigid_body.kinematic, obj.rotation_mode
        self._basis = obj.matrix_basis.copy()
        if self._had_keys:
            animated.action = None
        obj.rigid_body.kinematic, obj.rotation_mode = True, "QUATERNION"
        for frame, pose in enumerate(poses, first):
            place, turn, _ = Matrix(pose).decompose()
            obj.location, obj.rotation_quaternion = place * FACTOR, turn
            obj.keyframe_insert("location", frame=frame)
            obj.keyframe_insert("rotation_quaternion", frame=frame)

    def release(self):
        """Restores the body."""
        obj = self._obj
        obj.animation_data.action = None
        obj.rotation_mode, obj.matrix_basis = self._mode, self._basis
        obj.rigid_body.kinematic = self._kinematic
        if self._had_keys:
            obj.animation_data.action, obj.animation_data.action_slot = self._keys
        else:
            obj.animation_data_clear()
