# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the liquid or gas of a fluid's domain (see agents.protocol.measures.motion.MatterMeasure). Metres."""

import bpy
import numpy

from ..blend.fluids import domain_of
from ..geometry.evaluated_meshes import coordinates, transformed
from ..geometry.solids import NoSurface, Unmeasurable
from .movement import actor_of

# Cells from a side of the domain up to which matter is at it: the solver keeps the outermost ones empty.
_NEAR = {"LIQUID": 1.5, "GAS": 2.1}
_ROUND_SOURCE = 2.0  # cells around a source that still belong to it


def matter(request, solids):
    """How much there is in a domain, and the shares of it that are at the domain's lid, at its sides, off its sources.

    {} while there is nothing.
    """
    actor = actor_of((request["domain"],))
    obj, graph = actor.objects[0], bpy.context.evaluated_depsgraph_get()
    domain = domain_of(obj)
    if domain is None:
        raise Unmeasurable(f"{obj.name!r} is not the domain of a fluid")
    state = actor.state_at(graph)
    if state is None:
        return {}
    low, high = _own_box(obj)
    cell = float((high - low).max()) / max(1, domain.resolution_max)
    places, weights = state.places[state.alive], state.weights
    weights = numpy.ones(len(places)) if weights is None else weights
    whole = float(weights.sum())
    near = _NEAR[domain.domain_type] * cell
    top = places[:, 2] > high[2] - near
    sides = ((places < low + near) | (places > high - near))[:, :2].any(axis=1)
    away = numpy.ones(len(places), bool)
    for name in request["sources"]:
        source = bpy.context.scene.objects.get(name)
        if source is not None and source.type == "MESH":
            first, last = _own_box(source)
            margin = _ROUND_SOURCE * cell
            away &= ~((places > first - margin) & (places < last + margin)).all(axis=1)
    answer = {
        "lid": float(weights[top].sum()) / whole,
        "sides": float(weights[sides].sum()) / whole,
        "away": float(weights[away].sum()) / whole,
    }
    if domain.domain_type == "LIQUID" and domain.use_mesh:
        answer["volume"] = _volume(solids, obj.name)
    return answer


def _own_box(obj):
    """(low, high) of an object's own mesh in the world, without what its modifiers make of it."""
    places = transformed(coordinates(obj.data.vertices), obj.matrix_world)
    if not len(places):
        raise Unmeasurable(f"{obj.name!r} has no vertices")
    return places.min(axis=0), places.max(axis=0)


def _volume(solids, name):
    """What a liquid's surface encloses, in m³; None where it has none."""
    try:
        solid = solids[name]
    except NoSurface:
        return None
    corners = solid.points[solid.triangles] - solid.points.mean(axis=0)
    return abs(float(numpy.einsum("ij,ij->", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])))) / 6
