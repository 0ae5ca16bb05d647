# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes that are freed, cut short, lost or forgotten."""

import bpy

from .lookup import fluids_of, modifiers_of


def free(things, types):
    """Frees the bakes of modifiers."""
    found = modifiers_of(things, types)
    for _, modifier in found:
        _free(_cache_of(modifier))
    return [thing for thing, _ in found]


def free_world(things):
    """Frees the bake of the rigid-body world."""
    del things
    _free(bpy.context.scene.rigidbody_world.point_cache)
    return _simulated()


def shorten(things, types):
    """Has the caches of modifiers end in the middle of the clip."""
    found = modifiers_of(things, types)
    for _, modifier in found:
        _cache_of(modifier).frame_end = _middle()
    return [thing for thing, _ in found]


def shorten_world(things):
    """Has the cache of the rigid-body world end in the middle of the clip."""
    del things
    bpy.context.scene.rigidbody_world.point_cache.frame_end = _middle()
    return _simulated()


def lose_files(things):
    """Has all fluids look for their files where there are none; what they know of their bakes stays."""
    del things
    found = fluids_of("DOMAIN")
    for number, (_, settings) in enumerate(found):
        settings.cache_directory = f"//lost/{number}"
    return [thing for thing, _ in found]


def forget_bake(things):
    """Has all fluids forget that they are baked; their files stay. A cache of type REPLAY knows of no bake."""
    del things
    found = [(thing, settings) for thing, settings in fluids_of("DOMAIN") if settings.cache_type != "REPLAY"]
    for _, settings in found:
        # Blender takes back what it knows of the bake when the resolution is set, to whatever value.
        settings.resolution_max = settings.resolution_max
    return [thing for thing, _ in found]


def _cache_of(modifier):
    return (modifier.particle_system if modifier.type == "PARTICLE_SYSTEM" else modifier).point_cache


def _free(cache):
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.free_bake()


def _simulated():
    return [thing for thing in bpy.context.scene.objects if thing.rigid_body is not None]


def _middle():
    scene = bpy.context.scene
    return (scene.frame_start + scene.frame_end) // 2
