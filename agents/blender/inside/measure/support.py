# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how objects rest on, lean on or penetrate others (see agents.protocol.measures.contact)."""

import math

import numpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..geometry.contact_points import contact_points, normals_of
from ..geometry.penetration import penetration
from ..geometry.solids import Unmeasurable
from ..geometry.topology import spread_numbers, topology_of

_UP = 0.1  # cosine; a surface that faces up less than this supports nothing
_FLOOR = 0.9  # cosine; a surface that faces up more than this is a floor
_LOOKED_DOWN = 2000  # points from which rays go down, or up
_SEVERAL = 6
_EDGE = 1e-5
_AROUND = numpy.array([(math.cos(turn * math.pi / 32), math.sin(turn * math.pi / 32)) for turn in range(64)])


def depth(request, solids):
    """How deep two groups of objects penetrate each other, mesh by mesh."""
    ours, theirs = ([solids[name] for name in request[side]] for side in "ab")
    lows, highs = (numpy.array([getattr(solid, side) for solid in theirs]) for side in ("low", "high"))
    deepest = {"depth": 0.0, "at": None}
    for solid in ours:
        for place in numpy.nonzero(((lows <= solid.high) & (highs >= solid.low)).all(axis=1))[0]:
            shared = penetration(solid, theirs[place])
            if shared is None:
                continue
            deep, where, reason = shared
            if deep is None:
                raise Unmeasurable(f"{solid.name!r} and {theirs[place].name!r} cross, but {reason}")
            if deep > deepest["depth"]:
                deepest = {"depth": deep, "at": tuple(where)}
    return deepest


def support(request, solids):
    """The contacts that support a child from below, and its centre of mass."""
    child, parents = solids.joined(request["child"]), solids.joined(request["parents"])
    contacts = contact_points(child, parents, request["within"])
    result = {"centre": centre_of_mass([solids[name] for name in request["child"]]), "bearing": []}
    opposed = numpy.full(len(contacts), 2.0)
    for own, other in normals_of(child, parents, contacts) if len(contacts) else ():
        from_below = (other[:, 2] > _UP) & (own[:, 2] < 0)
        cosine = numpy.einsum("ij,ij->i", own, other)
        opposed = numpy.where(from_below, numpy.minimum(opposed, cosine), opposed)
    if (opposed <= 1).any():
        result["opposed"] = float(opposed.min())
        result["at"] = contacts.places[int(opposed.argmin())].tolist()
        result["bearing"] = _outline(contacts.places[opposed <= request["opposed"]])
    else:
        result.update(_clearance(child, parents, request["within"]))
    return result


def _outline(places):
    """The outermost of some points, seen from above."""
    if not len(places):
        return []
    return places[numpy.unique((places[:, :2] @ _AROUND.T).argmax(axis=0))].tolist()


def _clearance(child, parents, within):
    """How far a child is above its parents, and where; {} if they are not below it."""
    best = None
    for upper, lower, direction in ((child, parents, -1), (parents, child, 1)):
        places = upper.points
        if len(upper.triangles) < _LOOKED_DOWN:
            places = numpy.concatenate([places, places[upper.triangles].mean(axis=1)])
        # A point exactly above an edge counts as beside it.
        inside = (places[:, :2] > lower.low[:2] + _EDGE) & (places[:, :2] < lower.high[:2] - _EDGE)
        places = places[inside.all(axis=1)]
        for place in places[spread_numbers(len(places), _LOOKED_DOWN)].tolist():
            start = Vector((place[0], place[1], place[2] - direction * within))
            hit, _, _, distance = lower.tree.ray_cast(start, Vector((0, 0, direction)))
            if hit is not None and (best is None or distance < best[0]):
                best = distance, place
    return {} if best is None else {"clearance": max(0.0, best[0] - within), "at": best[1]}


def centre_of_mass(solids):
    """The centre of mass of the closed pieces of some solids, taken as full; without any, of their surfaces."""
    whole, moments = 0.0, numpy.zeros(3)
    for solid in solids:
        _, volumes, parts = topology_of(solid).volumes()
        whole += float(numpy.abs(volumes).sum())
        moments += (numpy.sign(volumes) * parts).sum(axis=1)
    if whole <= 0:
        for solid in solids:
            topology = topology_of(solid)
            whole += float(topology.areas.sum())
            moments += (topology.areas[:, None] * topology.places[topology.corners].mean(axis=1)).sum(axis=0)
    if whole <= 0:
        raise Unmeasurable(f"{solids[0].name!r} has faces without an area, so no centre of mass")
    return (moments / whole).tolist()


def flush(request, solids):
    """The angle between touching faces of child and parent, and how far the child's face overhangs."""
    child, parent = solids.joined(request["child"]), solids.joined(request["parent"])
    within = request["within"]
    contacts = contact_points(child, parent, within)
    ranked = []
    for own, other in normals_of(child, parent, contacts) if len(contacts) else ():
        cosine = numpy.einsum("ij,ij->i", own, other)
        floor = other[:, 2] > _FLOOR
        if request["sideways"]:
            cosine, floor = numpy.where(floor, 2.0, cosine), numpy.zeros(len(floor), bool)
        order = numpy.lexsort((cosine.round(5), floor))[: len(contacts)]
        ranked += [
            (bool(floor[at]), float(cosine[at]), int(at), other[at]) for at in order[:200] if cosine[at] <= 1
        ]
    if not ranked:
        return {"touching": []}
    ranked.sort(key=lambda entry: entry[:2])
    best_floor, best = ranked[0][:2]
    faces = {}
    for floor, cosine, at, normal in ranked:
        if floor == best_floor and cosine <= best + 1e-4 and len(faces) < _SEVERAL:
            plane = (*normal.round(2), round(float(normal @ contacts.places[at]) / max(within, 1e-6)))
            faces.setdefault(plane, (at, normal))
    over, at = min(
        (_overhang((child, contacts.own[at]), (parent, contacts.other[at]), normal, within), at)
        for at, normal in faces.values()
    )
    return {
        "angle": math.degrees(math.acos(max(-1.0, min(1.0, -best)))),
        "stands_out": over,
        "at": contacts.places[at].tolist(),
        "touching": _outline(contacts.places),
    }


def _overhang(child, parent, normal, within):
    """How far the face of one (solid, triangle) extends beyond that of another, seen along a normal."""
    (ours, theirs), (own, face) = zip(
        *(
            (topology_of(solid), topology_of(solid).face_mask(triangle, normal, within))
            for solid, triangle in (child, parent)
        ),
        strict=True,
    )
    if not face.any() or not own.any():
        return 0.0
    corners = ours.places[numpy.unique(ours.corners[own])]
    corners = corners[spread_numbers(len(corners), _LOOKED_DOWN)]
    flat = _flattened(theirs.places, normal), theirs.corners[face]
    tree = BVHTree.FromPolygons(flat[0].tolist(), flat[1].tolist(), all_triangles=True)
    return max(tree.find_nearest(place)[3] for place in _flattened(corners, normal).tolist())


def _flattened(places, normal):
    return places - (places @ normal)[:, None] * normal
