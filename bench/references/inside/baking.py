# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes every simulation of the scene."""

import bpy


def bake(fluids_in):
    """Bakes all simulations. Each fluid has a folder of its own for its cache, below ``fluids_in`` (``//…``)."""
    scene = bpy.context.scene
    domains = [obj for obj in scene.objects if any(_is_domain(modifier) for modifier in obj.modifiers)]
    if scene.rigidbody_world is not None or _cached(scene):
        bpy.ops.ptcache.bake_all(bake=True)
    for hairs in _moving_hair(scene):  # which Blender leaves out when it bakes all
        with bpy.context.temp_override(point_cache=hairs.point_cache):
            bpy.ops.ptcache.bake(bake=True)
    for number, obj in enumerate(domains):
        settings = next(modifier for modifier in obj.modifiers if _is_domain(modifier)).domain_settings
        settings.cache_directory = f"{fluids_in}/{number}"
        with bpy.context.temp_override(object=obj, active_object=obj):
            bpy.ops.fluid.bake_all()


def _is_domain(modifier):
    return modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN"


def _moving_hair(scene):
    systems = [system for obj in scene.objects for system in obj.particle_systems]
    return [system for system in systems if system.settings.type == "HAIR" and system.use_hair_dynamics]


def _cached(scene):
    kinds = {"CLOTH", "SOFT_BODY", "PARTICLE_SYSTEM", "DYNAMIC_PAINT"}
    return any(modifier.type in kinds for obj in scene.objects for modifier in obj.modifiers)
