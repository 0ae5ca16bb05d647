# SPDX-License-Identifier: GPL-3.0-or-later
"""The simulations of a scene, and playing those that are not baked."""

import os
from collections import namedtuple

import bpy

# ``label``: in words; ``first``: frame; ``on_disk``: its baked frames are files; ``points``: its point cache, or None.
Simulation = namedtuple("Simulation", "label first baked on_disk points")


def find_simulations(scene):
    """All simulations of a scene that are switched on in the viewport."""
    world = scene.rigidbody_world
    if world is not None and world.enabled and world.point_cache is not None:
        yield _of_points("the rigid-body world", world.point_cache)
    for obj in scene.objects:
        for modifier in obj.modifiers:
            if modifier.show_viewport:
                yield from _of_modifier(scene, obj, modifier)


def play_to_current_frame(scene, folder):
    """Sets the current frame, stepping to it if a simulation is not baked; a fluid's files go to ``folder``.

    A frame that is jumped to would show such a simulation as it never was.
    """
    current = scene.frame_current
    unbaked = [each for each in find_simulations(scene) if not each.baked]
    _redirect_fluids(scene, folder)
    for each in unbaked:
        if each.points is not None:
            each.points.frame_step = each.points.frame_step  # setting it drops what was kept of jumped frames
    for frame in range(min([current, *(each.first for each in unbaked)]), current + 1):
        scene.frame_set(frame)


def _of_points(label, cache):
    on_disk = cache.use_disk_cache or cache.use_external
    return Simulation(label, cache.frame_start, cache.is_baked and not cache.is_outdated, on_disk, cache)


def _of_modifier(scene, obj, modifier):
    label = repr(obj.name)
    if modifier.type in {"CLOTH", "SOFT_BODY"}:
        yield _of_points(label, modifier.point_cache)
    elif modifier.type == "PARTICLE_SYSTEM" and (system := modifier.particle_system) is not None:
        kind = system.settings.type if system.settings is not None else None
        if kind == "EMITTER" or (kind == "HAIR" and system.use_hair_dynamics):
            yield _of_points(label, system.point_cache)
    elif modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings is not None:
        for surface in modifier.canvas_settings.canvas_surfaces:
            if surface.is_cache_user:
                yield _of_points(label, surface.point_cache)
    elif (domain := _domain_of(modifier)) is not None:
        yield Simulation(label, domain.cache_frame_start, _is_baked(domain), on_disk=True, points=None)
    elif modifier.type == "NODES" and _has_zone(modifier.node_group, set()):
        yield Simulation(
            label, scene.frame_start, baked=False, on_disk=False, points=None
        )  # no property tells


def _domain_of(modifier):
    is_domain = modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN"
    return modifier.domain_settings if is_domain else None


def _is_baked(domain):
    if not domain.has_cache_baked_data:
        return False
    if domain.domain_type == "LIQUID":
        return not domain.use_mesh or domain.has_cache_baked_mesh
    return not domain.use_noise or domain.has_cache_baked_noise


def _redirect_fluids(scene, folder):
    for obj in scene.objects:
        for number, modifier in enumerate(obj.modifiers):
            domain = _domain_of(modifier)
            if domain is not None and not domain.has_cache_baked_data:
                name = bpy.path.clean_name(obj.name)
                domain.cache_directory = os.path.join(folder, f"fluid-{name}-{number}")


def _has_zone(tree, seen):
    if tree is None or tree in seen:
        return False
    seen.add(tree)
    return any(
        node.bl_idname == "GeometryNodeSimulationOutput" or _has_zone(getattr(node, "node_tree", None), seen)
        for node in tree.nodes
    )
