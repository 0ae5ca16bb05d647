# SPDX-License-Identifier: GPL-3.0-or-later
"""Inner edges that make a soft body of a hollow mesh behave like jelly, dough or rubber."""

import bmesh
from mathutils.bvhtree import BVHTree
from mathutils.kdtree import KDTree

_LEAN = 0.6  # about 30 degrees: so that the struts of neighbours cross, and hold against shear


def braced(obj):
    """Adds edges across the inside of a closed mesh, from each point to the opposite side, straight and leaning.

    A soft body has springs only along its edges: without these it collapses like a bag. They do not render.
    """
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bm.verts.ensure_lookup_table()
    bm.normal_update()
    tree, points = BVHTree.FromBMesh(bm), KDTree(len(bm.verts))
    for vertex in bm.verts:
        points.insert(vertex.co, vertex.index)
    points.balance()
    ends = {pair for vertex in bm.verts for pair in _opposite(vertex, tree, points)}
    for pair in sorted(ends):
        both = [bm.verts[number] for number in pair]
        if bm.edges.get(both) is None:
            bm.edges.new(both)
    bm.to_mesh(obj.data)
    bm.free()
    return obj


def _opposite(vertex, tree, points):
    """Pairs of a vertex with those nearest to where lines inwards come out again."""
    inward = -vertex.normal
    aside = _LEAN * inward.orthogonal().normalized()
    across = inward.cross(aside)
    for lean in (0 * aside, aside, -aside, across, -across):
        way = (inward + lean).normalized()
        out = tree.ray_cast(vertex.co + 1e-4 * way, way)[0]
        if out is not None and (other := points.find(out)[1]) != vertex.index:
            yield min(vertex.index, other), max(vertex.index, other)
