# SPDX-License-Identifier: GPL-3.0-or-later
"""Node sockets: RNA does not describe them, so every node is made once and asked.

Sockets that a node shows only in some of its modes (``ShaderNodeMix.data_type``) carry those modes.
"""

import re

import bpy

from .rna import read_items
from .wire import limit, plain

TREES = ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree")


def menu_items(socket):
    """A menu socket's choices. RNA has none to list; refusing a wrong one, Blender names them all."""
    try:
        socket.default_value = "\x01"
    except TypeError as refusal:
        return [
            {"identifier": name}
            for name in re.findall(r"'([^']*)'", str(refusal).partition("not found in")[2])
        ]
    return []


def available(socket):
    """Whether a socket can be seen in the node's present mode."""
    return socket.enabled and not getattr(socket, "is_unavailable", False)


def describe(socket):
    """One socket in the terms of ``records.Symbol``."""
    row = {"label": socket.name, "type": socket.type.lower(), "target": socket.bl_idname}
    row["description"] = getattr(socket, "description", "")
    prop = socket.bl_rna.properties.get("default_value")
    if prop is None or not hasattr(socket, "default_value"):
        return row
    if prop.type not in {"POINTER", "COLLECTION"}:
        row["default"] = plain(socket.default_value)
    else:
        row["target"] = prop.fixed_type.identifier
    if prop.type in {"INT", "FLOAT"}:
        # The soft range follows the declaration of this very socket; RNA's class-wide one says nothing.
        row["subtype"] = prop.subtype if prop.subtype != "NONE" else ""
        row["hard_min"], row["hard_max"] = limit(prop.hard_min), limit(prop.hard_max)
        row["soft_min"], row["soft_max"] = limit(prop.soft_min), limit(prop.soft_max)
    if socket.type == "MENU":
        row["enum_items"] = menu_items(socket)
    return row


def keyed(sockets):
    """(side, identifier) → socket for both sides of a node."""
    return {
        (side, socket.identifier): socket for side, collection in sockets.items() for socket in collection
    }


def sides(node):
    """A node's two socket collections."""
    return {"inputs": node.inputs, "outputs": node.outputs}


def mode_enums(node):
    """The enum properties that belong to the node's own class and have more than one value."""
    inherited = set(bpy.types.Node.bl_rna.properties.keys())
    for prop in node.bl_rna.properties:
        if (
            prop.type == "ENUM"
            and prop.identifier not in inherited
            and not prop.is_readonly
            and not prop.is_enum_flag
        ):
            values = [row["identifier"] for row in read_items(prop.enum_items_static)]
            if len(values) > 1 and getattr(node, prop.identifier) in values:
                yield prop.identifier, values


def vary_modes(node, rows, order):
    """Sets every mode in turn; returns (side, identifier) → the modes that show the socket."""
    modes = {}
    for name, values in mode_enums(node):
        before = getattr(node, name)
        shown = {}
        for value in values:
            try:
                setattr(node, name, value)
            except (TypeError, AttributeError):
                continue
            for key, socket in keyed(sides(node)).items():
                if key not in rows:
                    rows[key] = describe(socket)
                    order.append(key)
                if available(socket):
                    shown.setdefault(key, []).append(value)
        setattr(node, name, before)
        tried = {value for row in shown.values() for value in row}
        for key in rows:
            if set(shown.get(key, ())) != tried and shown.get(key):
                modes.setdefault(key, []).append(f"{name}={'|'.join(shown[key])}")
    return modes


def make(trees, identifier):
    """(node, names of the tree types that take it), the node in the first of them; (None, []) if none does."""
    first, taken = None, []
    for name, tree in trees.items():
        try:
            node = tree.nodes.new(identifier)
        except RuntimeError:
            continue
        taken.append(name)
        if first is None:
            first = node
        else:
            tree.nodes.remove(node)
    return first, taken


def write_node(write, owner, node):
    """The sockets of one node, in their order; of several with one name, Python's lookup finds the first."""
    rows, order = {}, []
    for key, socket in keyed(sides(node)).items():
        rows[key] = describe(socket)
        order.append(key)
    hidden = {key for key, socket in keyed(sides(node)).items() if not available(socket)}
    modes = vary_modes(node, rows, order)
    named, index = set(), {"inputs": 0, "outputs": 0}
    for side, identifier in order:
        row = rows[side, identifier]
        spelling = row["label"] if row["label"] and (side, row["label"]) not in named else identifier
        if (side, spelling) in named:
            continue
        named.add((side, spelling))
        write(
            "symbol",
            path=f'{owner}.{side}["{spelling}"]',
            kind="socket",
            owner=owner,
            signature=f"{side}[{index[side]}]",
            flags=[f"identifier:{identifier}"]
            + (["hidden-by-default"] if (side, identifier) in hidden else []),
            modes=modes.get((side, identifier), []),
            **row,
        )
        index[side] += 1


def compositing_scene():
    """A scratch scene with a compositor tree of its own: before Blender 5.0 some nodes go nowhere else."""
    if "node_tree" not in bpy.types.Scene.bl_rna.properties:
        return None
    scene = bpy.data.scenes.new("scratch")
    scene.use_nodes = True
    return scene


def write_all(write, structs):
    """The sockets of every node class that one of the built-in tree types takes."""
    trees = {}
    for name in TREES:
        try:
            trees[name] = bpy.data.node_groups.new("scratch", name)
        except TypeError:
            continue
    scene = compositing_scene()
    made = 0
    for identifier in sorted(structs):
        cls = getattr(bpy.types, identifier, None)
        if cls is None or not issubclass(cls, bpy.types.Node) or cls is bpy.types.Node:
            continue
        node, taken = make(trees, identifier)
        if node is None and scene is not None:
            node, taken = make({"CompositorNodeTree": scene.node_tree}, identifier)
        if node is None:
            continue
        made += 1
        owner = f"bpy.types.{identifier}"
        write("node", path=owner, trees=taken)
        write_node(write, owner, node)
        node.id_data.nodes.remove(node)
    for tree in trees.values():
        bpy.data.node_groups.remove(tree)
    if scene is not None:
        bpy.data.scenes.remove(scene)
    return made
