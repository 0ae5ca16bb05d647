# SPDX-License-Identifier: GPL-3.0-or-later
"""Frees, shortens or loses bakes."""

import bpy

from .lookup import fluids_of, modifiers_of


def free_bake(objects, types):
    """Frees the bakes of modifiers."""
    simulated = modifiers_of(objects, types)
    for _, modifier in simulated:
        _free(_cache_of(modifier))
    return [obj for obj, _ in simulated]


def free_world_bake(objects):
    """Frees the bake of the rigid-body world."""
    del objects
    _free(bpy.context.scene.rigidbody_world.point_cache)
    return _simulated()


def shorten_cache(objects, types):
    """Lets the caches of modifiers end in the middle of the clip."""
    simulated = modifiers_of(objects, types)
    for _, modifier in simulated:
        _cache_of(modifier).frame_end = _middle()
    return [obj for obj, _ in simulated]


def shorten_world_cache(objects):
    """Lets the cache of the rigid-body world end in the middle of the clip."""
    del objects
    bpy.context.scene.rigidbody_world.point_cache.frame_end = _middle()
    return _simulated()


def lose_fluid_files(objects):
    """Points all fluids to folders without files; their flags still say that they are baked."""
    del objects
    domains = fluids_of("DOMAIN")
    for number, (_, settings) in enumerate(domains):
        settings.cache_directory = f"//lost/{number}"
    return [obj for obj, _ in domains]


def clear_fluid_bake(objects):
    """Clears the flags that fluids are baked; their files stay. A cache of type REPLAY has no such flag."""
    del objects
    domains = [(obj, settings) for obj, settings in fluids_of("DOMAIN") if settings.cache_type != "REPLAY"]
    for _, settings in domains:
        # Blender clears the flags when the resolution is set, to whatever value.
        settings.resolution_max = settings.resolution_max
    return [obj for obj, _ in domains]


def _cache_of(modifier):
    return (modifier.particle_system if modifier.type == "PARTICLE_SYSTEM" else modifier).point_cache


def _free(cache):
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.free_bake()


def _simulated():
    return [obj for obj in bpy.context.scene.objects if obj.rigid_body is not None]


def _middle():
    scene = bpy.context.scene
    return (scene.frame_start + scene.frame_end) // 2
