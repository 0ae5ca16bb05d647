# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume of an actor, and how deep it is in other meshes."""

import contextlib

from ..blend.protocol_tags import object_collections
from ..geometry.penetration import penetration
from ..geometry.solids import Unmeasurable
from .actors import round_to

_MOST_PARTNERS = 20  # whose depth is measured


def solid_facts(actor, solids, scene):
    """{"volume": of closed meshes, "depth": how deep it is in another rendered mesh, "inside": that one's name}."""
    facts = {"volume": None, "depth": None, "inside": None}
    if actor.measured not in {"vertices", "fluid"}:
        return facts
    names = [obj.name for obj in actor.objects]
    try:
        solid = solids.joined(names)
    except Unmeasurable:
        return facts
    if solid.closed:
        facts["volume"] = round_to(_volume(solid), 1e-6)
    if actor.measured == "fluid":
        return facts
    own = {*names, *(obj.name for one in object_collections(scene) for obj in _own(one, names))}
    for other in _partners(solid, own, solids, scene):
        try:
            shared = penetration(solid, other)
        except Unmeasurable:
            continue
        if shared is not None and shared[0] is not None and shared[0] > (facts["depth"] or 0.0):
            facts["depth"], facts["inside"] = round_to(float(shared[0]), 1e-5), other.name
    return facts


def _own(collection, names):
    """All of an object of the protocol that has one of these: its cage is in its body, and in nothing else."""
    members = list(collection.all_objects)
    return members if any(obj.name in names for obj in members) else []


def _volume(solid):
    a, b, c = (solid.points[solid.triangles[:, corner]] for corner in range(3))
    first, second = b - a, c - a
    normal = first[:, [1, 2, 0]] * second[:, [2, 0, 1]] - first[:, [2, 0, 1]] * second[:, [1, 2, 0]]
    return abs(float((a * normal).sum()) / 6)


def _partners(solid, names, solids, scene):
    """The solids of other meshes that are rendered and whose boxes overlap that of ``solid``."""
    there = []
    for obj in scene.objects:
        if obj.type != "MESH" or obj.name in names or obj.hide_render or not obj.visible_get():
            continue
        if any(modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" for modifier in obj.modifiers):
            continue
        with contextlib.suppress(Unmeasurable):
            other = solids[obj.name]
            if (solid.low < other.high).all() and (other.low < solid.high).all():
                there.append(other)
                if len(there) == _MOST_PARTNERS:
                    break
    return there
