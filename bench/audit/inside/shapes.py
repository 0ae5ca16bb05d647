# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts of a mesh by itself: whether it is closed, how many loose pieces it has, which vertex groups have weights."""

import bpy
import numpy

from .json_values import text

MOST_COUNTED = 400_000  # edges, or vertices, of one mesh whose pieces are counted
MOST_WEIGHTED = 300_000  # vertices of one mesh, whose weights are looked at

MOST_LOOPS = 20_000_000  # corners of faces; a larger mesh counts as open

_known = {}  # mesh (by address) → (topology, islands): linked duplicates share it


def forget():
    """Forgets the last file's meshes; call it after another one is opened."""
    _known.clear()


def shape_of(data):
    """(``"open"``, ``"closed"`` or None, number of loose pieces) of an object's data."""
    if not isinstance(data, bpy.types.Mesh):
        return None, 0
    key = data.as_pointer()
    if key not in _known:
        _known[key] = _topology(data), _islands(data)
    return _known[key]


def _topology(mesh):
    """Closed: every edge of a face has two faces. Loose edges do not count: soft bodies have struts inside."""
    if not len(mesh.edges) or not len(mesh.polygons) or len(mesh.loops) > MOST_LOOPS:
        return "open"
    edges = numpy.empty(len(mesh.loops), dtype=numpy.int32)
    mesh.loops.foreach_get("edge_index", edges)
    uses = numpy.bincount(edges, minlength=len(mesh.edges))
    return "closed" if bool((uses[uses > 0] == 2).all()) else "open"


def _islands(mesh):
    """Connected pieces; 1 for a mesh that is too large to count."""
    if not len(mesh.vertices) or max(len(mesh.vertices), len(mesh.edges)) > MOST_COUNTED:
        return min(1, len(mesh.vertices))
    ends = numpy.empty(2 * len(mesh.edges), dtype=numpy.int32)
    mesh.edges.foreach_get("vertices", ends)
    first, second = ends[0::2], ends[1::2]
    labels = numpy.arange(len(mesh.vertices))
    while True:
        least = numpy.minimum(labels[first], labels[second])
        before = labels.copy()
        numpy.minimum.at(labels, first, least)
        numpy.minimum.at(labels, second, least)
        labels = labels[labels]
        if numpy.array_equal(labels, before):
            return len(numpy.unique(labels))


def vertex_groups_of(obj):
    """Its groups, each with the number of vertices that have a weight above zero; counted for simulated meshes only."""
    data = obj.data
    if not obj.vertex_groups or not isinstance(data, bpy.types.Mesh):
        return []
    counts = [0] * len(obj.vertex_groups)
    if any(modifier.type in {"CLOTH", "SOFT_BODY", "PARTICLE_SYSTEM"} for modifier in obj.modifiers):
        for number, vertex in enumerate(data.vertices):
            if number == MOST_WEIGHTED:
                break
            for each in vertex.groups:
                if each.weight > 0 and each.group < len(counts):
                    counts[each.group] += 1
    groups = zip(obj.vertex_groups, counts, strict=True)
    return [{"name": text(group.name), "weighted": count} for group, count in groups]
