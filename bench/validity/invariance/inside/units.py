# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene in centimetres: everything a hundred times as large, and a unit that is a hundredth of a metre.

What is baked stays baked, and shows the same: points in caches are multiplied where they lie; the rigid-body world,
whose cache cannot be taken out of the file, is baked anew with its bodies led along the paths that they took.
"""

import os

import bpy
import numpy
from mathutils import Matrix

from bench.audit.inside.channels import curves_of

from .point_cache_files import multiply

FACTOR = 100.0
_LENGTHS = ("location", "delta_location", "scale")


def rescale(cast):
    """Makes all lengths a hundred times as long, and the unit as much shorter. Returns how many objects there are."""
    del cast
    scene = bpy.context.scene
    paths = _paths_of_bodies(scene)
    _multiply_caches(scene)
    for thing in scene.objects:
        _enlarge(thing)
    for action in {each for thing in scene.objects for each in _actions(thing)}:
        _enlarge_curves(action)
    scene.gravity = [FACTOR * each for each in scene.gravity]
    units = scene.unit_settings
    units.system = "METRIC"
    units.scale_length /= FACTOR
    _bake_bodies(scene, paths)
    return len(scene.objects)


def _enlarge(thing):
    """An object with what is its own; what hangs on another gets larger with that."""
    if thing.parent is None:
        thing.location *= FACTOR
        thing.delta_location *= FACTOR
        thing.scale *= FACTOR
    if thing.type == "CAMERA":
        thing.data.clip_start *= FACTOR
        thing.data.clip_end *= FACTOR


def _actions(thing):
    animated = thing.animation_data
    if thing.parent is None and animated is not None and animated.action is not None:
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
    caches = [
        cache for thing in scene.objects for modifier in thing.modifiers if (cache := _cache_of(modifier))
    ]
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
    """{body that is simulated: its poses at every frame}, of a world that is baked."""
    world = scene.rigidbody_world
    if world is None or not world.point_cache.is_baked:
        return {}
    bodies = [thing for thing in world.collection.objects if thing.rigid_body.type == "ACTIVE"]
    found = {thing.name: [] for thing in bodies}
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for thing in bodies:
            found[thing.name].append(numpy.array(thing.evaluated_get(graph).matrix_world))
    scene.frame_set(scene.frame_start)
    return found


def _bake_bodies(scene, paths):
    """Bakes the world with its bodies led; then lets them be what they were."""
    if not paths:
        return
    cache = scene.rigidbody_world.point_cache
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.free_bake()
    led = [_Led(bpy.data.objects[name], scene.frame_start, poses) for name, poses in paths.items()]
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.bake(bake=True)
    for each in led:
        each.release()


class _Led:
    """A body that follows poses (4 × 4), enlarged, from frame ``first`` on."""

    def __init__(self, thing, first, poses):
        animated = thing.animation_data
        self._thing, self._had_keys = thing, animated is not None and animated.action is not None
        self._keys = (animated.action, animated.action_slot) if self._had_keys else None
        self._kinematic, self._mode = thing.rigid_body.kinematic, thing.rotation_mode
        self._basis = thing.matrix_basis.copy()
        if self._had_keys:
            animated.action = None
        thing.rigid_body.kinematic, thing.rotation_mode = True, "QUATERNION"
        for frame, pose in enumerate(poses, first):
            place, turn, _ = Matrix(pose).decompose()
            thing.location, thing.rotation_quaternion = place * FACTOR, turn
            thing.keyframe_insert("location", frame=frame)
            thing.keyframe_insert("rotation_quaternion", frame=frame)

    def release(self):
        """Makes it what it was."""
        thing = self._thing
        thing.animation_data.action = None
        thing.rotation_mode, thing.matrix_basis = self._mode, self._basis
        thing.rigid_body.kinematic = self._kinematic
        if self._had_keys:
            thing.animation_data.action, thing.animation_data.action_slot = self._keys
        else:
            thing.animation_data_clear()
