# SPDX-License-Identifier: GPL-3.0-or-later
"""What a set of objects is made of, as a file of another format can keep it. The frame changes for a while."""

import os
from collections import Counter

import bpy
import numpy

from ..geometry.evaluated_meshes import are_finite, coordinates, mesh_of, transformed
from ..physics.caches import find_caches

_MOST_MATERIALS = 200
_MOST_IMAGES = 40  # of one material
_MOST_NODES = 5000  # looked at in one material
_CACHED = {"MESH_SEQUENCE_CACHE", "TRANSFORM_CACHE"}


def describe(objects, frames=()):
    """The facts of objects, with their bounds at further ``frames``."""
    scene, together = bpy.context.scene, set(objects)
    triangles, vertices, with_faces, with_uvs = _counts(objects)
    low, high = _bounds(objects)
    materials = _materials(objects)
    animated = [obj for obj in objects if is_animated(obj)]
    return {
        "objects": dict(Counter(obj.type for obj in objects)),
        "vertices": vertices,
        "triangles": triangles,
        "meshes": with_faces,
        "uv_mapped": with_uvs,
        "low": low,
        "high": high,
        "parented": sum(obj.parent in together for obj in objects if obj.parent is not None),
        "animated": len(animated),
        "range": _action_range(animated),
        "poses": _poses(objects, frames, scene),
        "materials": materials[:_MOST_MATERIALS],
        "missing": sorted(
            {image["file"] for entry in materials for image in entry["images"] if image["missing"]}
        ),
    }


def unbaked(scene):
    """Names of simulations that are not baked, which no jump to a frame shows as they are."""
    return [cache.label for cache in find_caches(scene) if not cache.baked]


def is_animated(obj):
    """Whether an object moves or changes shape by keys or by a cache."""
    keys = getattr(obj.data, "shape_keys", None)
    if any(map(_has_keys, (obj, obj.data, keys))):
        return True
    return any(modifier.type in _CACHED for modifier in obj.modifiers) or any(
        constraint.type in _CACHED for constraint in obj.constraints
    )


def _has_keys(block):
    data = getattr(block, "animation_data", None)
    return data is not None and (data.action is not None or any(track.strips for track in data.nla_tracks))


def _action_range(animated):
    """[first, last] frame of the actions of objects; None where there is none."""
    actions = []
    for obj in animated:
        for block in (obj, obj.data, getattr(obj.data, "shape_keys", None)):
            data = getattr(block, "animation_data", None)
            if data is not None:
                actions += [
                    data.action,
                    *(strip.action for track in data.nla_tracks for strip in track.strips),
                ]
    ranges = [action.frame_range for action in actions if action is not None]
    if not ranges:
        return None
    return [int(min(first for first, _ in ranges)), int(max(last for _, last in ranges))]


# Geometry


def _counts(objects):
    """(triangles, vertices, objects with faces, objects with UV maps) of evaluated meshes."""
    graph = bpy.context.evaluated_depsgraph_get()
    triangles = vertices = with_faces = with_uvs = 0
    for obj in objects:
        with mesh_of(obj.evaluated_get(graph)) as mesh:
            if mesh is None:
                continue
            vertices += len(mesh.vertices)
            triangles += len(mesh.loops) - 2 * len(mesh.polygons)
            with_faces += bool(len(mesh.polygons))
            with_uvs += bool(len(mesh.uv_layers))
    return triangles, vertices, with_faces, with_uvs


def _bounds(objects):
    """(lowest, highest) corner of evaluated meshes in metres; Nones if there are none, or they are not finite."""
    graph = bpy.context.evaluated_depsgraph_get()
    corners = []
    for obj in objects:
        evaluated = obj.evaluated_get(graph)
        with mesh_of(evaluated) as mesh:
            if mesh is None:
                continue
            points = transformed(coordinates(mesh.vertices), evaluated.matrix_world)
            if not are_finite(points):
                return None, None
            corners += [points.min(axis=0), points.max(axis=0)]
    if not corners:
        return None, None
    metres = bpy.context.scene.unit_settings.scale_length or 1.0
    return [
        [float(value) for value in side * metres] for side in (numpy.min(corners, 0), numpy.max(corners, 0))
    ]


def _poses(objects, frames, scene):
    """The bounds at some frames; the scene's frame is as before afterwards."""
    before, subframe, poses = scene.frame_current, scene.frame_subframe, []
    try:
        for frame in frames:
            scene.frame_set(frame)
            low, high = _bounds(objects)
            if low is not None:
                poses.append({"frame": frame, "low": low, "high": high})
    finally:
        if frames:
            scene.frame_set(before, subframe=subframe)
    return poses


# Materials


def _materials(objects):
    """The materials in use, by name, each with the images that reach it and the socket that each reaches."""
    used = {slot.material for obj in objects for slot in obj.material_slots if slot.material is not None}
    return [
        {"name": material.name, "images": _images(material)}
        for material in sorted(used, key=lambda material: material.name)
    ]


def _images(material):
    """Images by the input that they reach: of a shader, or the one of the output."""
    tree = material.node_tree
    if tree is None:
        return []
    found = {}
    for node in tree.nodes:
        if not any(socket.type == "SHADER" for socket in node.outputs) and node.type != "OUTPUT_MATERIAL":
            continue
        for socket in node.inputs:
            if socket.is_linked and socket.type != "SHADER":
                for image in _behind(socket):
                    found.setdefault((image.name, socket.name), _image(image, socket.name))
    return list(found.values())[:_MOST_IMAGES]


def _behind(socket):
    """The images whose colours or alphas lead to a socket, through other nodes and groups."""
    pending, seen, images = [socket], set(), []
    while pending and len(seen) < _MOST_NODES:
        for link in pending.pop().links:
            node = link.from_node
            if node in seen:
                continue
            seen.add(node)
            if getattr(node, "image", None) is not None:
                images.append(node.image)
            if node.type == "GROUP" and node.node_tree is not None:
                images += [inner.image for inner in node.node_tree.nodes if getattr(inner, "image", None)]
            pending += [into for into in node.inputs if into.is_linked]
    return images


def _image(image, socket):
    path = bpy.path.abspath(image.filepath, library=image.library) if image.filepath else ""
    packed = image.packed_file is not None
    of_file = image.source == "FILE" and not image.is_dirty
    return {
        "name": image.name,
        "into": socket,
        "file": os.path.basename(path) or image.name,
        "packed": packed,
        "missing": not packed and of_file and not os.path.isfile(path),
    }
