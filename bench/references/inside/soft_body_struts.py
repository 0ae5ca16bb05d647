# SPDX-License-Identifier: GPL-3.0-or-later
"""What gives a hollow mesh the body of jelly, dough or rubber."""

import bmesh
from mathutils.bvhtree import BVHTree
from mathutils.kdtree import KDTree

_LEAN = 0.6  # about 30 degrees: so that the struts of neighbours cross, and hold against shear


def braced(thing):
    """Edges across the inside of a closed mesh, from each point to what lies opposite, straight and leaning.

    A soft body has springs along its edges, and no inside: without these it falls in like a bag. Renders show none.
    """
    made = bmesh.new()
    made.from_mesh(thing.data)
    made.verts.ensure_lookup_table()
    made.normal_update()
    tree, points = BVHTree.FromBMesh(made), KDTree(len(made.verts))
    for vertex in made.verts:
        points.insert(vertex.co, vertex.index)
    points.balance()
    ends = {pair for vertex in made.verts for pair in _opposite(vertex, tree, points)}
    for pair in sorted(ends):
        both = [made.verts[number] for number in pair]
        if made.edges.get(both) is None:
            made.edges.new(both)
    made.to_mesh(thing.data)
    made.free()
    return thing


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
