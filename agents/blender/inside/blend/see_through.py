# SPDX-License-Identifier: GPL-3.0-or-later
"""Through which objects one sees: those of glass, of little opacity, or of a volume alone."""

_CLEAR = 0.5  # a surface is see-through from this transmission up, or below this alpha
_SEEN_THROUGH = {"BSDF_GLASS", "BSDF_TRANSPARENT", "BSDF_REFRACTION"}


def is_see_through(obj):
    """Whether all of the object's materials are see-through; it has some."""
    slots = obj.material_slots
    return len(slots) > 0 and all(_is_see_through(slot.material) for slot in slots)


def has_see_through(obj):
    """Whether any of the object's materials is see-through."""
    return any(_is_see_through(slot.material) for slot in obj.material_slots)


def _is_see_through(material):
    """Whether a material is see-through: glass, low alpha, or only a volume."""
    tree = material.node_tree if material is not None and getattr(material, "use_nodes", True) else None
    if tree is None:
        return False
    output = tree.get_output_node("ALL")
    if output is None:
        return False
    shaders = _shaders(output.inputs["Surface"], set())
    if not shaders:
        return output.inputs["Volume"].is_linked
    return any(_lets_through(node) for node in shaders)


def _shaders(socket, seen):
    """The shader nodes that lead to a socket."""
    nodes = []
    for link in socket.links:
        node = link.from_node
        if node.name in seen:
            continue
        seen.add(node.name)
        if node.type.startswith(("BSDF", "EMISSION")):
            nodes.append(node)
        else:
            for below in node.inputs:
                if below.type == "SHADER":
                    nodes += _shaders(below, seen)
    return nodes


def _lets_through(node):
    if node.type in _SEEN_THROUGH:
        return True
    if node.type != "BSDF_PRINCIPLED":
        return False
    values = {
        socket.name: socket.default_value
        for socket in node.inputs
        if socket.name in {"Transmission Weight", "Transmission", "Alpha"}
    }
    linked = {socket.name for socket in node.inputs if socket.is_linked}
    alpha = 1.0 if "Alpha" in linked else values.pop("Alpha", 1.0)
    values.pop("Alpha", None)
    return alpha < _CLEAR or any(value >= _CLEAR for value in values.values())
