# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports a file of another format into a collection of its own, so that nothing of it stays outside the scene."""

import contextlib
import math
import os
import shutil

import bpy
from mathutils import Matrix

from simworlds.sandbox.inside.refusal import Refused

from ..blend.cache_folders import unused_name
from ..blend.temporary import temporary_settings
from . import formats
from .facts import describe
from .references import check_file, is_inside

_FOLDER = (
    "imported"  # in the workspace: files that Blender reads again and again, as those of animated geometry
)
_LARGE, _SMALL, _FAR = 500.0, 0.005, 10.0  # metres, metres, times its own size
_UP = {"Y": ("Y", "NEGATIVE_Z"), "Z": ("Z", "Y")}  # up → (up, forward)
_SCENE_SETTINGS = ("frame_start", "frame_end", "world", "camera")


def import_file(arguments, report):
    """Imports ``path`` of the format ``kind``; returns what came in.

    ``root``: the folder that the file may refer to. ``workspace``: where the run's files are.
    ``scale`` multiplies sizes; ``up``: the file's upward axis, where the format does not say. ``collection``: a name
    for the new one. ``frames``: at which bounds are measured as well. ``timing``: (fps, its base, frame), which an
    empty scene gets first.
    """
    kind, path, workspace = arguments["kind"], arguments["path"], arguments["workspace"]
    report(0, None, "checking the file")
    check_file(kind, path, arguments["root"])
    scene = bpy.context.scene
    if arguments["timing"]:
        scene.render.fps, scene.render.fps_base, frame = arguments["timing"]
        scene.frame_set(frame)
    path = _kept_copy(path, workspace) if kind == "abc" else path
    before = {name: {*getattr(bpy.data, name)} for name in ("objects", "images", "cache_files", "worlds")}
    collection = bpy.data.collections.new(arguments["collection"])
    scene.collection.children.link(collection)
    report(0, None, f"reading {os.path.basename(path)}")
    settings = [(scene, name, getattr(scene, name)) for name in _SCENE_SETTINGS]
    settings += [(scene.render, name, getattr(scene.render, name)) for name in ("fps", "fps_base")]
    with temporary_settings(settings), _alone_in(collection):
        formats.read(kind, path, **_settings(kind, arguments["scale"], arguments["up"]))
    objects = [obj for obj in bpy.data.objects if obj not in before["objects"]]
    if not objects:
        raise Refused(f"Nothing came in: {os.path.basename(path)} has no objects, or is damaged.")
    _gather(objects, collection)
    if kind == "gltf" and arguments["scale"] != 1.0:
        _scale_roots(objects, arguments["scale"])
    report(0, None, "packing images and counting")
    images = [image for image in bpy.data.images if image not in before["images"]]
    outside = _pack(images, arguments["root"], workspace)
    caches = [cache for cache in bpy.data.cache_files if cache not in before["cache_files"]]
    scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)  # else what came in is not evaluated
    facts = describe(objects, arguments["frames"])
    return {
        **facts,
        "collection": collection.name,
        "roots": sorted(obj.name for obj in objects if obj.parent is None)[:50],
        "outside": outside,
        "reads_on": sorted({bpy.path.abspath(cache.filepath) for cache in caches}),
        "notes": [*_size_notes(facts), *_transform_notes(objects)],
    }


def _settings(kind, scale, up):
    if kind == "gltf":
        return {}
    settings = {"scale": scale, "global_scale": scale}
    if kind in {"obj", "stl"} and up:
        upward, forward = _UP[up]
        settings |= {"up_axis": upward, "forward_axis": forward}
        settings |= {"axis_up": upward, "axis_forward": forward.replace("NEGATIVE_", "-")}
    return settings


def _kept_copy(path, workspace):
    """A copy of a file in the workspace, where it stays for what reads it at every frame."""
    folder = os.path.join(workspace, _FOLDER)
    os.makedirs(folder, exist_ok=True)
    stem, end = os.path.splitext(os.path.basename(path))
    name = unused_name(stem, lambda name: os.path.lexists(os.path.join(folder, name + end)))
    return shutil.copyfile(path, os.path.join(folder, name + end))


@contextlib.contextmanager
def _alone_in(collection):
    """Makes a collection the one that importers put objects in; selection, mode and active object do not matter."""
    layer = bpy.context.view_layer
    active, before = layer.objects.active, layer.active_layer_collection
    if active is not None and active.mode != "OBJECT":
        with contextlib.suppress(RuntimeError):
            bpy.ops.object.mode_set(mode="OBJECT")
    selected = [obj for obj in layer.objects if obj.select_get()]
    layer.active_layer_collection = layer.layer_collection.children[collection.name]
    try:
        yield
    finally:
        layer.active_layer_collection = before
        for obj in layer.objects:
            obj.select_set(obj in selected)
        layer.objects.active = active


def _gather(objects, collection):
    """Puts objects that importers have put elsewhere into the collection too, and removes from elsewhere."""
    inside = {collection, *collection.children_recursive}
    for obj in objects:
        places = set(obj.users_collection)
        if not places & inside:
            for place in places:
                place.objects.unlink(obj)
            collection.objects.link(obj)


def _scale_roots(objects, scale):
    """Scales about the world's origin what the importer itself cannot."""
    top = bpy.data.objects.new("scale", None)
    objects[0].users_collection[0].objects.link(top)
    for obj in objects:
        if obj.parent is None:
            obj.parent = top
            obj.matrix_parent_inverse = Matrix()
    top.scale = (scale, scale, scale)
    objects.append(top)


def _pack(images, root, workspace):
    """Packs images whose files lie where the import may read; returns the paths of the others, which are dropped."""
    outside = []
    for image in images:
        if image.packed_file is not None or image.source != "FILE" or not image.filepath:
            continue
        path = bpy.path.abspath(image.filepath)
        if not os.path.isfile(path):
            continue
        if not is_inside(path, root) and not is_inside(path, workspace):
            outside.append(path)
            image.filepath_raw = f"//{os.path.basename(path)}"
            image.buffers_free()
            continue
        with contextlib.suppress(RuntimeError):  # no image: it is listed as missing
            image.pack()
    return sorted({*outside})


# What is odd


def _size_notes(facts):
    if "MESH" in facts["objects"] and not facts["meshes"]:
        yield "its meshes have no faces: the file may be damaged"
    if facts["low"] is None:
        if facts["meshes"]:
            yield "its bounds cannot be measured: it has points that are not finite or absurdly far away"
        return
    sides = [high - low for low, high in zip(facts["low"], facts["high"], strict=True)]
    longest = max(sides)
    if longest > _LARGE:
        yield (
            f"it is {longest:,.0f} m long: if its unit is the centimetre or the millimetre, import it with "
            "scale=0.01 or scale=0.001"
        )
    if 0 < longest < _SMALL:
        yield f"it is only {longest * 1000:.2g} mm long: its unit may be larger than the metre; see scale"
    centre = [(low + high) / 2 for low, high in zip(facts["low"], facts["high"], strict=True)]
    away = math.hypot(*centre)
    if away > max(_FAR * longest, _FAR):
        yield f"its middle is {away:,.0f} m away from the world's origin"


def _transform_notes(objects):
    scales = {obj.name: obj.matrix_world.to_scale() for obj in objects}
    mirrored = [obj.name for obj in objects if obj.matrix_world.determinant() < 0]
    uneven = [
        name for name, scale in scales.items() if max(map(abs, scale)) > 1.001 * min(map(abs, scale)) + 1e-9
    ]
    roots = [obj for obj in objects if obj.parent is None]
    turned = [obj.name for obj in roots if abs(abs(obj.matrix_world.to_euler().x) - math.pi / 2) < 1e-3]
    grown = [obj.name for obj in roots if not 0.5 < max(map(abs, scales[obj.name])) < 2.0]
    yield from _about(mirrored, "mirrored (negative scale)")
    yield from _about(uneven, "scaled unevenly")
    yield from _about(
        turned,
        "turned by 90° about X, as files with Y upwards often leave their objects; their shape is upright",
    )
    yield from _about(grown, "scaled as a whole by the file's unit; apply the scale before physics")


def _about(names, words):
    if names:
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        yield f"{', '.join(sorted(names)[:3])}{more}: {words}"
