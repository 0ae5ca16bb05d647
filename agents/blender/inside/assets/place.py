# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts an asset into the scene: appended data-blocks, a texture set as a material, an HDRI as the world."""

import math
import os

import bpy
from mathutils import Matrix

from simworlds.sandbox.inside.refusal import Refused

from ..blend.file_io import reason
from ..blend.named_objects import objects_named
from ..blend.names import quoted
from .read import load_marked

_STEP = 320  # between nodes
_INPUTS = {"roughness": "Roughness", "metallic": "Metallic", "alpha": "Alpha"}
_COLOURED = {"base_color", "emission"}


def place_asset(arguments, report):
    """Appends the asset (``kind``, ``name``) of the .blend ``path``.

    It is moved to ``location``; a material is assigned to ``objects``. Returns ``made``, ``assigned``,
    ``connected`` and ``notes``.
    """
    path, kind, name = arguments["path"], arguments["kind"], arguments["name"]
    targets = _targets(arguments["objects"])
    report(0, None, f"appending {name}")
    before = {obj.name_full for obj in bpy.data.objects}
    try:
        blocks = load_marked(path, (kind, name), link=False)[kind]
    except (RuntimeError, OSError) as error:
        raise Refused(f"{os.path.basename(path)} cannot be read: {reason(error)[:300]}") from None
    if not blocks:
        raise Refused(f"{os.path.basename(path)} has no {kind} {name!r} any more; search again.")
    block, notes = blocks[0], []
    scene = bpy.context.scene
    if kind == "object":
        scene.collection.objects.link(block)
    elif kind == "collection":
        scene.collection.children.link(block)
    elif kind == "world":
        scene.world = block
    elif kind == "node_group":
        block.use_fake_user = True
        notes.append("the node group is in the file; add it by a modifier or a node")
    elif not targets:
        block.use_fake_user = True
        notes.append("the material is in the file; no object has it yet")
    new = [obj for obj in bpy.data.objects if obj.name_full not in before]
    for obj in new:
        if not obj.users_collection:  # what the asset refers to, as its children
            scene.collection.objects.link(obj)
    roots = [obj for obj in new if obj.parent is None]
    for obj in roots:
        obj.matrix_basis = Matrix.Translation(arguments["location"]) @ obj.matrix_basis
    assigned = _assign(block, targets) if kind == "material" else []
    _pack(notes)
    made = {kind: [block.name], "objects": sorted(obj.name for obj in new)[:200]}
    return {"made": made, "assigned": assigned, "connected": {}, "notes": notes}


def connect_textures(arguments, report):
    """Puts ``maps`` ({map: path}) into the material called ``material``, a new one if there is none.

    It is assigned to ``objects``. ``repeat``: how often the maps repeat over the UV map. Returns as ``place_asset``.
    """
    targets = _targets(arguments["objects"])
    report(0, None, "loading the maps")
    name = arguments["material"]
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    tree, notes, connected = material.node_tree, [], {}
    shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    output = next((node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"), None)
    if output is None:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
    if shader is None:
        shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    mapping = _mapping(tree, arguments["repeat"])
    colours = {
        kind: _image_node(tree, mapping, path, number, coloured=kind in _COLOURED)
        for number, (kind, path) in enumerate(sorted(arguments["maps"].items()))
    }
    outputs = {kind: node.outputs["Color"] for kind, node in colours.items()}
    if "occlusion_roughness_metallic" in outputs:
        parts = tree.nodes.new("ShaderNodeSeparateColor")
        tree.links.new(outputs.pop("occlusion_roughness_metallic"), parts.inputs[0])
        for kind, part in zip(("ambient_occlusion", "roughness", "metallic"), parts.outputs, strict=True):
            outputs.setdefault(kind, part)
    if "glossiness" in outputs:
        invert = tree.nodes.new("ShaderNodeInvert")
        tree.links.new(outputs.pop("glossiness"), invert.inputs["Color"])
        outputs.setdefault("roughness", invert.outputs["Color"])
    for kind, place in _connections(tree, shader, output, outputs):
        connected[kind] = place
    assigned = _assign(material, targets)
    bare = [obj.name for obj in targets if obj.type == "MESH" and not obj.data.uv_layers]
    if bare:
        notes.append(f"without a UV map, so the maps cannot lie on it: {quoted(bare, 5)}")
    if not targets:
        material.use_fake_user = True
        notes.append("the material is in the file; no object has it yet")
    made = {"material": [material.name], "images": _image_names(colours.values())}
    return {"made": made, "assigned": assigned, "connected": connected, "notes": notes}


def set_world(arguments, report):
    """Makes the HDRI ``path`` the world, packed, with ``strength`` and ``rotation`` (degrees)."""
    report(0, None, f"loading {os.path.basename(arguments['path'])}")
    world = bpy.data.worlds.new(arguments["name"])
    if world.node_tree is None:
        world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputWorld")
    background = tree.nodes.new("ShaderNodeBackground")
    picture = tree.nodes.new("ShaderNodeTexEnvironment")
    turn, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    _show(picture, _packed_image(arguments["path"], coloured=True))
    _set_input(background, "Strength", arguments["strength"])
    _set_input(turn, "Rotation", (0.0, 0.0, math.radians(arguments["rotation"])))
    tree.links.new(place.outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    tree.links.new(picture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs["Background"], output.inputs["Surface"])
    for number, node in enumerate((place, turn, picture, background, output)):
        node.location = (_STEP * (number - 4), 0)
    bpy.context.scene.world = world
    made = {"world": [world.name], "images": _image_names([picture])}
    return {"made": made, "assigned": [], "connected": {"hdri": "World"}, "notes": []}


# Nodes


def _show(node, image):
    node.image = image


def _set_input(node, name, value):
    node.inputs[name].default_value = value


def _image_names(nodes):
    return [node.image.name for node in nodes]


def _mapping(tree, repeat):
    place, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    tree.links.new(place.outputs["UV"], mapping.inputs["Vector"])
    mapping.inputs["Scale"].default_value = (repeat, repeat, repeat)
    place.location, mapping.location = (-5 * _STEP, 0), (-4 * _STEP, 0)
    return mapping


def _image_node(tree, mapping, path, number, *, coloured):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = _packed_image(path, coloured=coloured)
    node.location = (-3 * _STEP, 300 - 300 * number)
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    return node


def _packed_image(path, *, coloured):
    try:
        image = bpy.data.images.load(path)
        image.pack()
    except RuntimeError as error:
        raise Refused(f"{os.path.basename(path)} cannot be read: {reason(error)[:300]}") from None
    if not all(image.size):
        raise Refused(f"{os.path.basename(path)} is not an image that Blender reads.")
    if not coloured:
        image.colorspace_settings.is_data = True
    return image


def _connections(tree, shader, output, outputs):
    """Connects colours of maps to what they mean; yields (map, input)."""
    links = tree.links
    base, occlusion = outputs.get("base_color"), outputs.get("ambient_occlusion")
    if base is not None and occlusion is not None:
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type, mix.blend_type, mix.location = "RGBA", "MULTIPLY", (-1.5 * _STEP, 300)
        mix.inputs["Factor"].default_value = 1.0
        colours = [socket for socket in mix.inputs if socket.type == "RGBA"]
        links.new(base, colours[0])
        links.new(occlusion, colours[1])
        base = next(socket for socket in mix.outputs if socket.type == "RGBA")
        yield "ambient_occlusion", "Base Color"
    if base is not None:
        links.new(base, shader.inputs["Base Color"])
        yield "base_color", "Base Color"
    for kind, name in _INPUTS.items():
        if kind in outputs:
            links.new(outputs[kind], shader.inputs[name])
            yield kind, name
    if "emission" in outputs:
        links.new(outputs["emission"], shader.inputs["Emission Color"])
        shader.inputs["Emission Strength"].default_value = 1.0
        yield "emission", "Emission Color"
    normal = outputs.get("normal") or _as_opengl(tree, outputs.get("normal_directx"))
    if normal is not None:
        bend = tree.nodes.new("ShaderNodeNormalMap")
        bend.location = (-_STEP, -300)
        links.new(normal, bend.inputs["Color"])
        links.new(bend.outputs["Normal"], shader.inputs["Normal"])
        yield "normal", "Normal"
    if "displacement" in outputs:
        raised = tree.nodes.new("ShaderNodeDisplacement")
        raised.inputs["Scale"].default_value = 0.02
        raised.location = (-_STEP, -600)
        links.new(outputs["displacement"], raised.inputs["Height"])
        links.new(raised.outputs["Displacement"], output.inputs["Displacement"])
        yield "displacement", "Displacement"


def _as_opengl(tree, colour):
    """A normal map of DirectX as Blender wants it: green the other way round."""
    if colour is None:
        return None
    curves = tree.nodes.new("ShaderNodeRGBCurve")
    curves.location = (-1.5 * _STEP, -300)
    green = curves.mapping.curves[1]
    green.points[0].location, green.points[1].location = (0.0, 1.0), (1.0, 0.0)
    curves.mapping.update()
    tree.links.new(colour, curves.inputs["Color"])
    return curves.outputs["Color"]


# Objects


def _targets(names):
    """The objects of these names. Raises Refused."""
    named = objects_named(bpy.context.scene, names)
    return list(dict.fromkeys(obj for objects in named.values() for obj in objects))


def _assign(material, objects):
    """Makes it the only material of objects that can have one; returns their names."""
    assigned = []
    for obj in objects:
        if getattr(obj.data, "materials", None) is not None:
            obj.data.materials.clear()
            obj.data.materials.append(material)
            assigned.append(obj.name)
    return assigned


def _pack(notes):
    for image in bpy.data.images:
        if image.source == "FILE" and image.packed_file is None and image.filepath and image.library is None:
            try:
                image.pack()
            except RuntimeError:
                notes.append(f"missing image file: {os.path.basename(image.filepath)}")
