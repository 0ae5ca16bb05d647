# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen and how: materials, cameras, lights, the world, the settings of a render."""

import math

import bpy
from mathutils import Vector

from .rna_values import differing, number, numbers, plain, text

# Inputs of a surface that say what it looks like; the others are told where they are linked, or in full.
_TELLING = {
    *("Base Color", "Color", "Metallic", "Roughness", "Alpha", "Transmission Weight", "Transmission", "IOR"),
    *("Emission Color", "Emission Strength", "Emission", "Strength", "Density", "Subsurface Weight"),
}
_NOTHING = {"Metallic": 0, "Alpha": 1, "Transmission Weight": 0, "Transmission": 0, "Subsurface Weight": 0}
_IOR = (1.45, 1.5)  # what shaders begin with, by version and kind
MOST_NODES = 120
MOST_SOCKETS = 60


def material_facts(material, detail):
    """A material: what its surface is, which inputs are linked, the colour of the viewport."""
    told = {"name": text(material.name), "users": material.users}
    told["viewport"] = numbers(material.diffuse_color)
    tree = material.node_tree
    if tree is not None:
        told.update(_surface(tree, "OUTPUT_MATERIAL"))
        told["nodes"] = len(tree.nodes)
        if detail == "full":
            told["tree"] = _tree(tree)
    method = getattr(material, "surface_render_method", "DITHERED")
    if method != "DITHERED":
        told["surface_render_method"] = method
    if detail == "full":
        settings = differing(material, leave=("diffuse_color",))
        if settings:
            told["settings"] = settings
    if material.library is not None:
        told["linked"] = text(material.library.filepath)
    return told


def camera_facts(thing, scene):
    """A camera with the direction that it looks in."""
    camera = thing.data
    told = {"kind": "camera", "name": text(thing.name)}
    if scene.camera is not None and scene.camera.name_full == thing.name_full:
        told["active"] = True
    told.update(_placed(thing))
    told["type"] = camera.type
    if camera.type == "ORTHO":
        told["ortho_scale"] = number(camera.ortho_scale)
    else:
        told["lens"] = number(camera.lens)
        told["angle"] = number(math.degrees(camera.angle))
    told["clip"] = numbers((camera.clip_start, camera.clip_end))
    settings = differing(camera, leave=_CAMERA_TOLD)
    if camera.dof.use_dof:
        focus = camera.dof.focus_object
        settings["dof"] = {
            "focus": text(focus.name) if focus is not None else number(camera.dof.focus_distance),
            "fstop": number(camera.dof.aperture_fstop),
        }
    if settings:
        told["settings"] = settings
    return told


_CAMERA_TOLD = (
    *(
        "lens",
        "angle",
        "angle_x",
        "angle_y",
        "ortho_scale",
        "clip_start",
        "clip_end",
        "lens_unit",
        "display_size",
    ),
    *("show_name", "show_limits", "show_mist", "show_sensor", "passepartout_alpha", "show_passepartout"),
)


def light_facts(thing):
    """A light: power in watts (of a sun: strength), colour, size, the direction that it shines in."""
    light = thing.data
    told = {"kind": "light", "name": text(thing.name), "type": light.type}
    told.update(_placed(thing, direction=light.type != "POINT"))
    told["energy"] = number(light.energy)
    told["color"] = numbers(light.color)
    told.update(_size_of_light(light))
    if settings := differing(light, leave=_LIGHT_TOLD):
        told["settings"] = settings
    tree = light.node_tree
    if tree is not None and len(tree.nodes) > 2:
        told["nodes"] = len(tree.nodes)
    return told


_LIGHT_TOLD = (
    *("energy", "color", "temperature_color", "angle", "spot_size", "shadow_soft_size", "show_cone"),
    *("shape", "size", "size_y"),
)


def _size_of_light(light):
    """What softens its shadows, and of a spot the width of its cone; angles in degrees."""
    if light.type == "SUN":
        return {"angle": number(math.degrees(light.angle))}
    if light.type == "AREA":
        long = light.shape in {"RECTANGLE", "ELLIPSE"}
        return {
            "shape": light.shape,
            "size": numbers((light.size, light.size_y)) if long else number(light.size),
        }
    told = {"radius": number(light.shadow_soft_size)}
    if light.type == "SPOT":
        told["spot_size"] = number(math.degrees(light.spot_size))
    return told


def world_facts(world, detail):
    """The background: its shader, or its plain colour where it has no nodes."""
    told = {"kind": "world", "name": text(world.name)}
    if world.node_tree is None:
        told["color"] = numbers(world.color)
        return told
    told.update(_surface(world.node_tree, "OUTPUT_WORLD"))
    told["nodes"] = len(world.node_tree.nodes)
    if detail == "full":
        told["tree"] = _tree(world.node_tree)
    return told


def _placed(thing, direction=True):
    matrix = thing.matrix_world
    told = {"location": numbers(matrix.translation)}
    if direction:
        ahead = matrix.to_3x3() @ Vector((0.0, 0.0, -1.0))
        told["direction"] = [
            number(round(one, 3) if math.isfinite(one) else one) for one in ahead.normalized()
        ]
    return told


def _surface(tree, kind):
    """{"surface": {"shader", inputs…}} of what is linked to the active output."""
    outputs = [node for node in tree.nodes if node.type == kind]
    output = next((node for node in outputs if node.is_active_output), outputs[0] if outputs else None)
    if output is None:
        return {"surface": None}
    told = {}
    for name in ("Surface", "Volume", "Displacement"):
        socket = output.inputs.get(name)
        if socket is None or not socket.is_linked:
            continue
        node = _behind(socket)
        if node is not None:
            told[name.lower()] = _node_facts(node, everything=False)
    return told or {"surface": None}


def _behind(socket):
    """The node that a linked input takes its value from."""
    links = socket.links
    for _ in range(32):  # reroutes may follow each other in a ring
        if not links:
            return None
        node = links[0].from_node
        if node.type != "REROUTE":
            return node
        links = node.inputs[0].links
    return None


def _node_facts(node, everything):
    told = {"shader": text(node.bl_label or node.type)}
    group = getattr(node, "node_tree", None)
    if group is not None:
        told["shader"] = f"group {text(group.name)}"
    inputs = {}
    for socket in list(node.inputs)[:MOST_SOCKETS]:
        name = text(socket.name)
        if socket.is_linked:
            source = _behind(socket)
            inputs[name] = f"<- {_source(source)}" if source is not None else "<-"
            continue
        if not socket.enabled or socket.hide_value or not hasattr(socket, "default_value"):
            continue
        if everything or (name in _TELLING and not _usual(name, socket, node)):
            inputs[name] = plain(socket.default_value)
    if inputs:
        told["inputs"] = inputs
    return told


def _source(node):
    image = getattr(node, "image", None)
    return text(node.label or node.name) + (f" ({text(image.name)})" if image is not None else "")


def _usual(name, socket, node):
    value = socket.default_value
    if name in _NOTHING:
        return value == _NOTHING[name]
    if name == "IOR":
        return any(abs(value - usual) < 1e-5 for usual in _IOR)
    if name == "Emission Color":
        strength = node.inputs.get("Emission Strength")
        return strength is None or (not strength.is_linked and strength.default_value == 0)
    return name == "Emission Strength" and value == 0


def _tree(tree):
    """All nodes with the values of their unlinked inputs, and what their linked ones come from."""
    nodes = []
    for node in tree.nodes:
        if len(nodes) == MOST_NODES:
            nodes.append({"name": f"… {len(tree.nodes) - MOST_NODES} more", "shader": ""})
            break
        told = {"name": text(node.name), **_node_facts(node, everything=True)}
        own = _own_settings(node)
        if own:
            told["settings"] = own
        if node.mute:
            told["muted"] = True
        nodes.append(told)
    return nodes


def _own_settings(node):
    """The settings of a node's own type that are not as RNA has them."""
    return differing(node, leave=bpy.types.Node.bl_rna.properties.keys())


def render_facts(scene, detail):
    """What a render of the scene is made with; the settings that are not as a new scene has them."""
    render = scene.render
    told = {"kind": "render", "name": text(scene.name), "engine": render.engine}
    told["output"] = text(render.filepath)
    told["format"] = render.image_settings.file_format
    told["view_transform"] = scene.view_settings.view_transform
    settings = differing(render, leave=_RENDER_TOLD)
    engine = {"CYCLES": "cycles", "BLENDER_EEVEE": "eevee", "BLENDER_EEVEE_NEXT": "eevee"}.get(render.engine)
    own = getattr(scene, engine, None) if engine else None
    if own is not None:
        settings.update({f"{engine}.{name}": value for name, value in differing(own).items()})
    for name, struct in (("image_settings", render.image_settings), ("view_settings", scene.view_settings)):
        found = differing(struct, leave=("file_format", "view_transform"))
        settings.update({f"{name}.{key}": value for key, value in found.items()})
    if render.image_settings.file_format == "FFMPEG":
        found = differing(render.ffmpeg)
        settings.update({f"ffmpeg.{key}": value for key, value in found.items()})
    limit = None if detail == "full" else 24
    if settings:
        told["settings"] = dict(list(settings.items())[:limit])
        if limit is not None and len(settings) > limit:
            told["settings_left_out"] = len(settings) - limit
    return told


_RENDER_TOLD = (
    *("engine", "filepath", "fps", "fps_base", "resolution_x", "resolution_y", "resolution_percentage"),
)
