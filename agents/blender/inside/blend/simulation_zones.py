# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulation zones of geometry nodes. Whether they are baked, no property tells."""


def objects_with_zones(scene):
    """The objects of a scene with a simulation zone in a modifier that is shown in the viewport, once for each."""
    return [
        obj
        for obj in scene.objects
        for modifier in obj.modifiers
        if modifier.type == "NODES" and modifier.show_viewport and _has_zone(modifier.node_group, set())
    ]


def _has_zone(tree, seen):
    """Whether a node tree, or a group in it, has a simulation zone."""
    if tree is None or tree in seen:
        return False
    seen.add(tree)
    return any(
        node.bl_idname == "GeometryNodeSimulationOutput" or _has_zone(getattr(node, "node_tree", None), seen)
        for node in tree.nodes
    )
