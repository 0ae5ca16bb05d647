# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, cameras, lights, the world and render settings in a readout."""

import math
from collections import Counter

import bpy
from mathutils import Vector

from .new_nodes import new_inputs
from .rna_values import changed_settings, number, numbers, text, to_json

# Inputs that a summary of a shader lists; the others are listed if they are linked, or in full detail.
_SUMMARY_INPUTS = {
    *("Base Color", "Color", "Metallic", "Roughness", "Alpha", "Transmission Weight", "Transmission", "IOR"),
    *("Emission Color", "Emission Strength", "Emission", "Strength", "Density", "Subsurface Weight"),
}
_NO_EFFECT = {"Metallic": 0, "Alpha": 1, "Transmission Weight": 0, "Transmission": 0, "Subsurface Weight": 0}
_IOR = (1.45, 1.5)  # defaults of shaders, by version and kind
MOST_NODES = 120
MOST_SOCKETS = 60


def material_facts(material, detail):
    """A material: its surface shader, its linked inputs, its viewport colour."""
    entry = {"name": text(material.name), "users": material.users}
    entry["viewport"] = numbers(material.diffuse_color)
    tree = material.node_tree
    if tree is not None:
        entry.update(_surface(tree, "OUTPUT_MATERIAL"))
        entry["nodes"] = len(tree.nodes)
        if detail == "full":
            entry["tree"] = _tree(tree)
    method = getattr(material, "surface_render_method", "DITHERED")
    if method != "DITHERED":
        entry["surface_render_method"] = method
    if detail == "full":
        settings = changed_settings(material, leave=("diffuse_color",))
        if settings:
            entry["settings"] = settings
    if material.library is not None:
        entry["linked"] = text(material.library.filepath)
    return entry


def camera_facts(obj, scene):
    """A camera, with its viewing direction."""
    camera = obj.data
    entry = {"kind": "camera", "name": text(obj.name)}
    if scene.camera is not None and scene.camera.name_full == obj.name_full:
        entry["active"] = True
    entry.update(_placement(obj))
    entry["type"] = camera.type
    if camera.type == "ORTHO":
        entry["ortho_scale"] = number(camera.ortho_scale)
    else:
        entry["lens"] = number(camera.lens)
        entry["angle"] = number(math.degrees(camera.angle))
    entry["clip"] = numbers((camera.clip_start, camera.clip_end))
    settings = changed_settings(camera, leave=_CAMERA_LISTED)
    if camera.dof.use_dof:
        focus = camera.dof.focus_object
        settings["dof"] = {
            "focus": text(focus.name) if focus is not None else number(camera.dof.focus_distance),
            "fstop": number(camera.dof.aperture_fstop),
        }
    if settings:
        entry["settings"] = settings
    return entry


_CAMERA_LISTED = (
    *("lens", "angle", "angle_x", "angle_y", "ortho_scale", "clip_start", "clip_end"),
    *("lens_unit", "display_size"),
    *("show_name", "show_limits", "show_mist", "show_sensor", "passepartout_alpha", "show_passepartout"),
)


def light_facts(obj):
    """A light: power in watts (of a sun: strength), colour, size, direction."""
    light = obj.data
    entry = {"kind": "light", "name": text(obj.name), "type": light.type}
    entry.update(_placement(obj, direction=light.type != "POINT"))
    entry["energy"] = number(light.energy)
    entry["color"] = numbers(light.color)
    entry.update(_size_of_light(light))
    if settings := changed_settings(light, leave=_LIGHT_LISTED):
        entry["settings"] = settings
    tree = light.node_tree
    if tree is not None and len(tree.nodes) > 2:
        entry["nodes"] = len(tree.nodes)
    return entry


_LIGHT_LISTED = (
    *("energy", "color", "temperature_color", "angle", "spot_size", "shadow_soft_size", "show_cone"),
    *("shape", "size", "size_y"),
)


def _size_of_light(light):
    """The size of its source, and of a spot the width of its cone; angles in degrees."""
    if light.type == "SUN":
        return {"angle": number(math.degrees(light.angle))}
    if light.type == "AREA":
        long = light.shape in {"RECTANGLE", "ELLIPSE"}
        return {
            "shape": light.shape,
            "size": numbers((light.size, light.size_y)) if long else number(light.size),
        }
    entry = {"radius": number(light.shadow_soft_size)}
    if light.type == "SPOT":
        entry["spot_size"] = number(math.degrees(light.spot_size))
    return entry


def world_facts(world, detail):
    """The world: its shader, or its colour if it has no nodes."""
    entry = {"kind": "world", "name": text(world.name)}
    if world.node_tree is None:
        entry["color"] = numbers(world.color)
        return entry
    entry.update(_surface(world.node_tree, "OUTPUT_WORLD"))
    entry["nodes"] = len(world.node_tree.nodes)
    if detail == "full":
        entry["tree"] = _tree(world.node_tree)
    return entry


def _placement(obj, direction=True):
    matrix = obj.matrix_world
    entry = {"location": numbers(matrix.translation)}
    if direction:
        ahead = matrix.to_3x3() @ Vector((0.0, 0.0, -1.0))
        entry["direction"] = [
            number(round(part, 3) if math.isfinite(part) else part) for part in ahead.normalized()
        ]
    return entry


def _surface(tree, kind):
    """{"surface": {"shader", inputs…}} of the nodes linked to the active output."""
    outputs = [node for node in tree.nodes if node.type == kind]
    output = next((node for node in outputs if node.is_active_output), outputs[0] if outputs else None)
    if output is None:
        return {"surface": None}
    entry = {}
    for name in ("Surface", "Volume", "Displacement"):
        socket = output.inputs.get(name)
        if socket is None or not socket.is_linked:
            continue
        node = _source_node(socket)
        if node is not None:
            entry[name.lower()] = _node_facts(node, everything=False)
            if mixed := _mixed_shaders(node):
                entry[name.lower()]["mixed"] = mixed
    return entry or {"surface": None}


def _mixed_shaders(node):
    """The shaders that a shader mixes, nearest first, without those that only mix others."""
    waiting, seen, mixed = [node], {node}, []
    while waiting and len(mixed) < _MOST_MIXED:
        for socket in list(waiting.pop(0).inputs)[:MOST_SOCKETS]:
            source = _source_node(socket) if socket.type == "SHADER" and socket.is_linked else None
            if source is None or source in seen:
                continue
            seen.add(source)
            if source.type in _MIXERS:
                waiting.append(source)
            elif len(mixed) < _MOST_MIXED:
                mixed.append({"name": text(source.name), **_node_facts(source, everything=False)})
    return mixed


def _source_node(socket):
    """The node that a linked input gets its value from."""
    links = socket.links
    for _ in range(32):  # reroutes may form a ring
        if not links:
            return None
        node = links[0].from_node
        if node.type != "REROUTE":
            return node
        links = node.inputs[0].links
    return None


def _node_facts(node, everything):
    """A node with its linked inputs, and the values of others: those that differ from a new node's, or, without
    ``everything``, the main ones."""
    entry = {"shader": text(node.bl_label or node.type)}
    group = getattr(node, "node_tree", None)
    if group is not None:
        entry["shader"] = f"group {text(group.name)}"
    shown = [(at, socket) for at, socket in enumerate(list(node.inputs)[:MOST_SOCKETS]) if _is_shown(socket)]
    names = Counter(socket.name for _, socket in shown)
    usual = new_inputs(node) if everything else {}
    inputs = {}
    for at, socket in shown:
        # Of sockets with the same name, a subscript by number tells which is meant.
        name = text(socket.name) + (f"[{at}]" if names[socket.name] > 1 else "")
        if socket.is_linked:
            source = _source_node(socket)
            inputs[name] = f"<- {_source(source)}" if source is not None else "<-"
            continue
        if socket.hide_value or not hasattr(socket, "default_value"):
            continue
        value = to_json(socket.default_value)
        if everything:
            if usual.get(socket.identifier) != value:
                inputs[name] = value
        elif socket.name in _SUMMARY_INPUTS and not _is_default(socket.name, socket, node):
            inputs[name] = value
    if inputs:
        entry["inputs"] = inputs
    return entry


def _is_shown(socket):
    return socket.is_linked or socket.enabled


def _source(node):
    image = getattr(node, "image", None)
    return text(node.label or node.name) + (f" ({text(image.name)})" if image is not None else "")


def _is_default(name, socket, node):
    value = socket.default_value
    if name in _NO_EFFECT:
        return value == _NO_EFFECT[name]
    if name == "IOR":
        return any(abs(value - usual) < 1e-5 for usual in _IOR)
    if name == "Emission Color":
        strength = node.inputs.get("Emission Strength")
        return strength is None or (not strength.is_linked and strength.default_value == 0)
    return name == "Emission Strength" and value == 0


def _tree(tree):
    """All nodes, with the sources of linked inputs, and of others the values that a new node does not have."""
    nodes = []
    for node in tree.nodes:
        if len(nodes) == MOST_NODES:
            nodes.append({"name": f"… {len(tree.nodes) - MOST_NODES} more", "shader": ""})
            break
        entry = {"name": text(node.name), **_node_facts(node, everything=True)}
        own = _own_settings(node)
        if own:
            entry["settings"] = own
        if node.mute:
            entry["muted"] = True
        nodes.append(entry)
    return nodes


def _own_settings(node):
    """The settings of a node's own type that are not at their defaults; the stops of a ramp, the points of curves."""
    settings = changed_settings(node, leave=bpy.types.Node.bl_rna.properties.keys())
    ramp = getattr(node, "color_ramp", None)
    if ramp is not None:
        settings["color_ramp"] = ramp_facts(ramp)
    curves = getattr(getattr(node, "mapping", None), "curves", None)
    if curves is not None:
        points = {
            str(at): curve_points(curve)
            for at, curve in enumerate(curves)
            if curve_points(curve) != _STRAIGHT
        }
        if points:
            settings["curves"] = points
    return settings


_STRAIGHT = [[0, 0], [1, 1]]
_MIXERS = ("MIX_SHADER", "ADD_SHADER")
_MOST_MIXED = 4


def ramp_facts(ramp):
    """A colour ramp: its stops as [position, colour], and its interpolation."""
    stops = [[number(stop.position), numbers(stop.color)] for stop in ramp.elements]
    return {"interpolation": ramp.interpolation, "stops": stops}


def curve_points(curve):
    """The points of a curve as [x, y]."""
    return [numbers(point.location) for point in list(curve.points)[:MOST_SOCKETS]]


def render_facts(scene, detail):
    """The render engine, output and settings that are not at their defaults."""
    render = scene.render
    entry = {"kind": "render", "name": text(scene.name), "engine": render.engine}
    entry["output"] = text(render.filepath)
    entry["format"] = render.image_settings.file_format
    entry["view_transform"] = scene.view_settings.view_transform
    settings = changed_settings(render, leave=_RENDER_LISTED)
    engine = {"CYCLES": "cycles", "BLENDER_EEVEE": "eevee", "BLENDER_EEVEE_NEXT": "eevee"}.get(render.engine)
    own = getattr(scene, engine, None) if engine else None
    if own is not None:
        settings.update({f"{engine}.{name}": value for name, value in changed_settings(own).items()})
    for name, struct in (("image_settings", render.image_settings), ("view_settings", scene.view_settings)):
        changed = changed_settings(struct, leave=("file_format", "view_transform"))
        settings.update({f"{name}.{key}": value for key, value in changed.items()})
    if render.image_settings.file_format == "FFMPEG":
        changed = changed_settings(render.ffmpeg)
        settings.update({f"ffmpeg.{key}": value for key, value in changed.items()})
    limit = None if detail == "full" else 24
    if settings:
        entry["settings"] = dict(list(settings.items())[:limit])
        if limit is not None and len(settings) > limit:
            entry["settings_left_out"] = len(settings) - limit
    return entry


_RENDER_LISTED = (
    *("engine", "filepath", "fps", "fps_base", "resolution_x", "resolution_y", "resolution_percentage"),
)
