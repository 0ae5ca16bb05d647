# SPDX-License-Identifier: GPL-3.0-or-later
"""The values that the inputs of a new node have."""

import bpy

from .rna_values import to_json

_known = {}  # type of node → {identifier of a socket: value}


def new_inputs(node):
    """{identifier of an input: its value in a new node of that type}; {} if such a node cannot be made."""
    group = getattr(node, "node_tree", None)
    if group is not None:
        return _of_interface(group)
    kind = node.bl_idname
    if kind not in _known:
        _known[kind] = _of_new_node(kind)
    return _known[kind]


def _of_interface(group):
    if not hasattr(group, "interface"):  # Blender before 4.0
        return {}
    return {
        item.identifier: to_json(item.default_value)
        for item in group.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT" and hasattr(item, "default_value")
    }


def _of_new_node(kind):
    """Makes one in a tree that is removed again."""
    tree = bpy.data.node_groups.new("new node", "ShaderNodeTree")
    try:
        sockets = tree.nodes.new(kind).inputs
        return {
            socket.identifier: to_json(socket.default_value)
            for socket in sockets
            if hasattr(socket, "default_value")
        }
    except RuntimeError:  # not a node of materials
        return {}
    finally:
        bpy.data.node_groups.remove(tree)
