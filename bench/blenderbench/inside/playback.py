# SPDX-License-Identifier: GPL-3.0-or-later
"""Plays simulations that are not baked up to the current frame."""

import os

from bench.audit.inside import sample_frames, solvers


def play_to_current_frame(scene, folder):
    """Sets the current frame, stepping to it if a simulation is not baked; a fluid's files go to ``folder``.

    A frame that is jumped to would show such a simulation as it never was.
    """
    first = current = scene.frame_current
    facts = {obj: {"modifiers": solvers.modifiers_of(obj)} for obj in scene.objects}
    if sample_frames.unbaked_of(scene, facts) or _has_simulation_zone(scene):
        first = min(first, scene.frame_start)
        for cache in point_caches(scene):
            if not cache.is_baked:
                first = min(first, cache.frame_start)
                cache.frame_step = cache.frame_step  # setting it drops what was kept of jumped frames
        for number, domain in enumerate(fluid_domains(scene)):
            if not domain.has_cache_baked_data:
                first = min(first, domain.cache_frame_start)
                domain.cache_directory = os.path.join(folder, f"fluid-{number}")
    for frame in range(first, current + 1):
        scene.frame_set(frame)


def point_caches(scene):
    """The point caches of a scene."""
    world = scene.rigidbody_world
    if world is not None and world.point_cache is not None:
        yield world.point_cache
    for obj in scene.objects:
        for modifier in obj.modifiers:
            if modifier.type in {"CLOTH", "SOFT_BODY"}:
                yield modifier.point_cache
            elif modifier.type == "PARTICLE_SYSTEM" and modifier.particle_system is not None:
                yield modifier.particle_system.point_cache
            elif modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings is not None:
                surfaces = modifier.canvas_settings.canvas_surfaces
                yield from (surface.point_cache for surface in surfaces if surface.is_cache_user)


def fluid_domains(scene):
    """The settings of the fluid domains of a scene."""
    modifiers = (modifier for obj in scene.objects for modifier in obj.modifiers)
    return [
        each.domain_settings for each in modifiers if each.type == "FLUID" and each.fluid_type == "DOMAIN"
    ]


def _has_simulation_zone(scene):
    """Whether geometry nodes simulate something. No property tells whether that is baked."""
    modifiers = (modifier for obj in scene.objects for modifier in obj.modifiers)
    return any(
        each.type == "NODES" and each.show_viewport and _has_zone(each.node_group, set())
        for each in modifiers
    )


def _has_zone(tree, seen):
    if tree is None or tree in seen:
        return False
    seen.add(tree)
    return any(
        node.bl_idname == "GeometryNodeSimulationOutput" or _has_zone(getattr(node, "node_tree", None), seen)
        for node in tree.nodes
    )
