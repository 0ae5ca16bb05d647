# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports objects to a file of another format. The scene is as before afterwards."""

import contextlib
import os

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.cache_folders import unused_name
from ..blend.named_objects import objects_named
from ..blend.names import quoted
from ..blend.temporary import temporary_settings
from . import formats
from .facts import describe, is_animated, unbaked

_NO_MOTION = {"obj", "stl"}
_CARRIED = {
    "stl": {"MESH", "CURVE", "SURFACE", "FONT", "META"},
    "obj": {"MESH", "CURVE", "SURFACE", "FONT", "META"},
}
_MOST_FILES = 2000


def available(arguments, report):
    """{format: {"reads", "writes"}} of this Blender, with its ``version``."""
    del arguments, report
    return {"version": bpy.app.version_string, "formats": formats.supported()}


def export_file(arguments, report):
    """Exports ``objects`` (names of objects, with what is parented to them, or of collections; none: all) to ``path``.

    ``path`` is in ``folder``, an empty one. ``animation``: with what moves over the scene's frames. Returns the facts
    of what was exported, the ``files`` below ``folder``, ``notes`` on what is left out, and the ``timing`` (fps, its
    base, the frame).
    """
    kind, path, folder = arguments["kind"], arguments["path"], arguments["folder"]
    scene = bpy.context.scene
    wanted = _wanted(arguments["objects"])
    os.makedirs(os.path.dirname(path), exist_ok=True)
    moving = arguments["animation"] and kind not in _NO_MOTION
    with contextlib.ExitStack() as undo:
        objects, notes = _select(undo, wanted, kind)
        if kind == "obj":
            _write_packed(
                undo, objects, folder
            )  # an OBJ's exporter names packed images as if they lay beside it
        if kind == "fbx":
            _write_packed(undo, objects, f"{folder}.images")
        frames = _frames(scene, objects, notes) if moving else []
        before = scene.frame_current, scene.frame_subframe
        if frames:
            scene.frame_set(
                before[0], subframe=before[1]
            )  # keyed values that were only set are no part of the motion
        report(0, None, "measuring")
        facts = describe(objects, frames)
        if not moving and kind not in _NO_MOTION:
            notes.append(f"without animation, as at frame {scene.frame_current}")
        report(0, None, f"writing {os.path.basename(path)}")
        try:
            formats.write(kind, path, **_settings(kind, path, objects, scene, moving))
        finally:
            scene.frame_set(before[0], subframe=before[1])
    files = _files(folder)
    if not files:
        raise Refused("Blender's exporter wrote nothing, without a reason.")
    return {
        **facts,
        "files": files,
        "timing": [scene.render.fps, scene.render.fps_base, scene.frame_current],
        "notes": notes,
    }


def _wanted(names):
    """The objects of these names and of these collections, with their descendants. Raises Refused."""
    layer = bpy.context.view_layer.objects
    if not names:
        return [*layer]
    wanted = {}
    for objects in objects_named(bpy.context.scene, names).values():
        for each in objects:
            wanted |= dict.fromkeys([each, *each.children_recursive])
    return [obj for obj in wanted if obj.name in layer]


def _select(undo, wanted, kind):
    """(objects that are selected now, notes on the others). Raises Refused if there are none."""
    layer = bpy.context.view_layer
    active, selected = layer.objects.active, [obj for obj in layer.objects if obj.select_get()]
    if active is not None and active.mode != "OBJECT":
        with contextlib.suppress(RuntimeError):
            bpy.ops.object.mode_set(mode="OBJECT")

    def put_back():
        for obj in layer.objects:
            obj.select_set(obj in selected)
        layer.objects.active = active

    undo.callback(put_back)
    carried = _CARRIED.get(kind)
    can, others = [], []
    for obj in wanted:
        (can if carried is None or obj.type in carried else others).append(obj)
    for obj in layer.objects:
        obj.select_set(False)
    for obj in can:
        obj.select_set(True)
    taken = [obj for obj in can if obj.select_get()]
    hidden = [obj.name for obj in can if not obj.select_get()]
    notes = []
    if others:
        notes.append(
            f"{kind} keeps no {', '.join(sorted({obj.type.lower() for obj in others}))}: {_names(others)}"
        )
    if hidden:
        notes.append(f"hidden, so not exported: {quoted(hidden, 5)}")
    if not taken:
        raise Refused(f"There is nothing to export: {'; '.join(notes) or 'the scene has no objects'}.")
    layer.objects.active = taken[0]
    return taken, notes


def _names(objects):
    return quoted([obj.name for obj in objects], 5)


def _frames(scene, objects, notes):
    """The frames at which the file is compared with the scene: its first and last, if anything moves and can be jumped
    to."""
    loose = unbaked(scene)
    if loose:
        notes.append(f"not baked, so its motion may be wrong in the file; bake first: {quoted(loose, 5)}")
        return []
    moves = any(map(is_animated, objects)) or any(obj.modifiers or obj.constraints for obj in objects)
    return [scene.frame_start, scene.frame_end] if moves else []


def _settings(kind, path, objects, scene, moving):
    """The settings that depend on what is exported; those that an exporter lacks are left out later."""
    if kind == "gltf":
        shapes = any(getattr(obj.data, "shape_keys", None) is not None for obj in objects)
        return {
            "export_format": "GLB" if path.lower().endswith(".glb") else "GLTF_SEPARATE",
            "export_animations": moving,
            "export_current_frame": not moving,
            "export_apply": not shapes,  # else shape keys are lost
        }
    if kind == "abc":
        now = scene.frame_current
        return {
            "start": scene.frame_start if moving else now,
            "end": scene.frame_end if moving else now,
            "init_scene_frame_range": False,
        }
    return {"export_animation": moving and kind == "usd", "bake_anim": moving}


def _write_packed(undo, objects, folder):
    """Writes packed and generated images to a folder, and makes them refer to their files until ``undo``."""
    images = {
        node.image
        for obj in objects
        for slot in obj.material_slots
        if slot.material is not None and slot.material.node_tree is not None
        for node in slot.material.node_tree.nodes
        if getattr(node, "image", None) is not None
    }
    taken = set()
    for image in sorted(images, key=lambda image: image.name):
        real = bpy.path.abspath(image.filepath) if image.filepath else ""
        if image.source not in {"FILE", "GENERATED"} or (
            os.path.isfile(real) and image.packed_file is None and not image.is_dirty
        ):
            continue
        stem, end = os.path.splitext(os.path.basename(real) or f"{bpy.path.clean_name(image.name)}.png")
        name = unused_name(stem, lambda name, end=end: name + end in taken) + end
        taken.add(name)
        path = os.path.join(folder, name)
        os.makedirs(folder, exist_ok=True)
        if image.packed_file is not None and not image.is_dirty:
            with open(path, "wb") as file:
                file.write(image.packed_file.data)
        else:
            with contextlib.suppress(RuntimeError):
                image.save(filepath=path, save_copy=True)
        if os.path.isfile(path):
            undo.enter_context(temporary_settings([(image, "filepath_raw", path)]))


def _files(folder):
    """The paths of all files below a folder, relative to it."""
    files = []
    for place, _, names in os.walk(folder):
        files += [os.path.relpath(os.path.join(place, name), folder) for name in names]
    if len(files) > _MOST_FILES:
        raise Refused(f"The export has {len(files)} files, more than {_MOST_FILES}; export fewer objects.")
    return sorted(files)
