# SPDX-License-Identifier: GPL-3.0-or-later
"""Likely causes why nothing moved in a simulation: the usual mistakes that this scene shows."""

import bpy
from mathutils import Vector

from . import caches

_GAS_FLOWS = {"SMOKE", "FIRE", "BOTH"}
_PINNED = 0.999  # weight from which a vertex does not move


def likely_causes(cache, scene):
    """Half sentences, the likeliest first; [] if none is found."""
    of_kind = {
        caches.CLOTH: _cloth,
        caches.SOFT_BODY: _soft_body,
        caches.PARTICLES: _particles,
        caches.RIGID_BODY: _bodies,
        caches.DYNAMIC_PAINT: _paint,
        caches.FLUID: _fluid,
    }
    causes = list(_switched_off(cache))
    causes += of_kind.get(cache.kind, lambda *_: ())(cache, scene)
    if cache.kind not in {caches.DYNAMIC_PAINT, caches.FLUID}:
        causes += _no_gravity(cache, scene)
    return causes


def _switched_off(cache):
    if cache.kind == caches.RIGID_BODY:
        if not cache.holder.enabled:
            yield "the rigid-body world is switched off (enabled is False)"
        return
    if not cache.modifier.show_viewport:
        yield f"the modifier {cache.modifier.name!r} is switched off in the viewport, so it is not simulated"
    if cache.owner.name not in bpy.context.view_layer.objects:
        yield f"{cache.owner.name!r} is not in the view layer, so it is not simulated"
    elif not cache.owner.visible_get():
        yield f"{cache.owner.name!r} is hidden, so it is not simulated"


def _no_gravity(cache, scene):
    if not scene.use_gravity or Vector(scene.gravity).length == 0:
        yield "the scene has no gravity"
    settings = cache.holder
    if cache.kind == caches.PARTICLES:
        settings = cache.holder.settings
    weights = getattr(settings, "effector_weights", None) or getattr(
        getattr(settings, "settings", None), "effector_weights", None
    )
    if weights is not None and weights.gravity == 0:
        yield "its effector_weights.gravity is 0"


def _all_pinned(obj, group_name):
    group = obj.vertex_groups.get(group_name) if group_name else None
    if group is None or obj.type != "MESH":
        return False
    return all(
        any(entry.group == group.index and entry.weight >= _PINNED for entry in vertex.groups)
        for vertex in obj.data.vertices
    )


def _cloth(cache, scene):
    del scene
    settings = cache.holder.settings
    if _all_pinned(cache.owner, settings.vertex_group_mass):
        yield f"every vertex is pinned by the vertex group {settings.vertex_group_mass!r}"
    if cache.owner.type == "MESH" and not cache.owner.data.vertices:
        yield "the mesh has no vertices"


def _soft_body(cache, scene):
    del scene
    settings = cache.holder.settings
    if settings.use_goal and not settings.vertex_group_goal:
        yield f"goal_default={settings.goal_default:.2f} holds every vertex in place (use_goal is on)"
    elif settings.use_goal and _all_pinned(cache.owner, settings.vertex_group_goal):
        yield f"every vertex is held by the vertex group {settings.vertex_group_goal!r}"


def _particles(cache, scene):
    del scene
    settings, (first, last) = cache.holder.settings, cache.range
    if settings.count == 0:
        yield "its count is 0"
    if settings.frame_start > last or settings.frame_end < first:
        yield f"it emits only in frames {settings.frame_start:g}–{settings.frame_end:g}, outside the range"
    if settings.physics_type == "NO":
        yield "its physics_type is NO, so particles do not move"
    if cache.owner.type == "MESH" and settings.emit_from == "FACE" and not cache.owner.data.polygons:
        yield "it emits from faces, but the mesh has none"


def _bodies(cache, scene):
    del scene
    collection = cache.holder.collection
    bodies = [obj for obj in collection.objects if obj.rigid_body] if collection is not None else []
    active = [obj for obj in bodies if obj.rigid_body.type == "ACTIVE"]
    if not bodies:
        yield "the rigid-body world's collection is empty"
    elif not active:
        yield "every body is PASSIVE"
    elif all(obj.rigid_body.kinematic for obj in active):
        yield "every active body is Animated (kinematic)"
    elif all(obj.rigid_body.use_start_deactivated for obj in active):
        yield "every active body starts deactivated, and nothing hits it"
    else:
        yield "all bodies rest where they are (correct for a stable stack)"
    if cache.holder.time_scale == 0:
        yield "the world's time_scale is 0"


def _paint(cache, scene):
    brushes = cache.holder.brush_collection.all_objects if cache.holder.brush_collection else scene.objects
    if not any(
        modifier.type == "DYNAMIC_PAINT" and modifier.brush_settings is not None
        for obj in brushes
        for modifier in obj.modifiers
    ):
        yield "the scene has no dynamic-paint brush"
    else:
        yield "no brush touches the canvas"
    surface = cache.holder
    if surface.surface_type == "PAINT" and surface.output_name_a not in getattr(
        cache.owner.data, "attributes", {}
    ):
        yield f"the mesh has no attribute {surface.output_name_a!r} (add it with bpy.ops.dpaint.output_toggle)"


def _fluid(cache, scene):
    domain = cache.domain
    gas = domain.domain_type == "GAS"
    inside, fitting = [], []
    for obj in domain.fluid_group.all_objects if domain.fluid_group else scene.objects:
        for modifier in obj.modifiers:
            if modifier.type != "FLUID" or modifier.fluid_type != "FLOW" or modifier.flow_settings is None:
                continue
            if not _boxes_overlap(cache.owner, obj):
                continue
            inside.append(obj)
            if (modifier.flow_settings.flow_type in _GAS_FLOWS) == gas:
                fitting.append(modifier.flow_settings)
    kind = "smoke or fire" if gas else "liquid"
    if not inside:
        yield "no flow object lies inside the domain" + (" or its fluid_group" if domain.fluid_group else "")
    elif not fitting:
        yield f"the domain is for {kind}, but no flow object inside it emits that (flow_type)"
    elif not any(flow.use_inflow for flow in fitting if flow.flow_behavior == "INFLOW") and all(
        flow.flow_behavior in {"INFLOW", "OUTFLOW"} for flow in fitting
    ):
        yield "no flow object emits anything (use_inflow, flow_behavior)"
    else:
        yield "the flow may be smaller than a cell: raise resolution_max, or volume_density for a thin mesh"
    if domain.time_scale == 0:
        yield "the domain's time_scale is 0"
    if not gas and (not scene.use_gravity or Vector(scene.gravity).length == 0):
        yield "the scene has no gravity"


def _boxes_overlap(obj, other):
    """Whether the boxes of two objects overlap."""
    lows, highs = [], []
    for each in (obj, other):
        corners = [each.matrix_world @ Vector(corner) for corner in each.bound_box]
        lows.append([min(axis) for axis in zip(*corners, strict=True)])
        highs.append([max(axis) for axis in zip(*corners, strict=True)])
    return all(lows[0][axis] <= highs[1][axis] and lows[1][axis] <= highs[0][axis] for axis in range(3))
