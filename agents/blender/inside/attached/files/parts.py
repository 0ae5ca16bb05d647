# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of a large scene that code touches: written by the open Blender, opened by the copy's."""

import os
import time

import bpy

from ...blend.file_io import make_own
from ..code.code_reach import Reach
from ..user_state import main_window
from . import libraries
from .copies import TooLarge, check_drawn, check_size, paths_used

_NAMED = (
    "objects", "collections", "materials", "meshes", "curves", "lights", "cameras", "worlds", "images", "node_groups",
    "actions", "armatures", "textures", "texts", "particles",
)  # fmt: skip
_SETTINGS = ("frame_start", "frame_end", "use_gravity", "gravity")
_OF_RENDER = ("fps", "fps_base", "resolution_x", "resolution_y", "resolution_percentage")
_NOT_BROUGHT = frozenset({"scenes", "screens", "workspaces", "window_managers", "libraries", "version"})


def write_part(arguments, report):
    """Writes what ``code`` names, and all that it needs, to ``path``, if that takes at most ``seconds``; or TooLarge.

    Instead of ``code`` there may be ``names``. ``objects`` and ``triangles`` are as for ``write_copy``. Returns
    ``objects`` (names), ``folders`` of other files, and the ``scene`` as ``load_part`` takes it.
    """
    del report
    reach = Reach(arguments.get("code", ""))
    reach.names.update(arguments.get("names", ()))
    if reach.everything:
        raise TooLarge(f"No part of it can be told from the code, in which {reach.everything}.")
    window = main_window()
    scene, layer = window.scene, window.view_layer
    selected = [obj for obj in layer.objects if obj.select_get(view_layer=layer)] if reach.selection else []
    active = layer.objects.active if reach.selection else None
    chosen = {
        block for kind in _NAMED for name in reach.names if (block := getattr(bpy.data, kind).get(name))
    }
    chosen.update(block for block in (*selected, active, scene.camera, scene.world) if block is not None)
    needed = _with_needs(chosen)
    if any(isinstance(block, bpy.types.Scene) for block in needed):
        raise TooLarge("What the code names depends on the whole scene.")
    check_drawn([block for block in needed if isinstance(block, bpy.types.Object)], arguments)
    check_size(needed, arguments["seconds"])
    started = time.perf_counter()
    libraries.write(arguments["path"], chosen, path_remap="ABSOLUTE", compress=False)
    objects = sorted(block.name for block in needed if isinstance(block, bpy.types.Object))
    tree = {scene.collection.name, *(own.name for own in scene.collection.children_recursive)}
    places = {
        obj: [own.name for own in bpy.data.objects[obj].users_collection if own.name in tree]
        for obj in objects
    }
    brought = sorted(
        block.name for block in needed if isinstance(block, bpy.types.Collection) and block.name in tree
    )
    return {
        "bytes": os.path.getsize(arguments["path"]),
        "seconds": time.perf_counter() - started,
        "objects": objects,
        "folders": paths_used(),
        "scene": {
            "name": scene.name,
            "top": scene.collection.name,
            "frame": scene.frame_current,
            "camera": scene.camera.name if scene.camera else None,
            "world": scene.world.name if scene.world else None,
            "active": active.name if active else None,
            "selected": [obj.name for obj in selected],
            "collections": brought,
            "places": places,
            "settings": {name: _plain(getattr(scene, name)) for name in _SETTINGS},
            "render": {name: getattr(scene.render, name) for name in _OF_RENDER},
        },
    }


def load_part(arguments, report):
    """Opens such a part, at ``path``, as the only scene; ``workspace`` as for ``portable_copy.load``."""
    del report
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    make_own(arguments["workspace"])
    with bpy.data.libraries.load(arguments["path"]) as (there, here):
        for kind in dir(there):
            if kind not in _NOT_BROUGHT:
                setattr(here, kind, getattr(there, kind))
    told, scene = arguments["scene"], bpy.context.scene
    scene.name = told["name"]
    for owner, values in ((scene, told["settings"]), (scene.render, told["render"])):
        for name, value in values.items():
            setattr(owner, name, value)
    for name in told["collections"]:
        _collection(scene, name, told["top"])
    for name, collections in told["places"].items():
        for place in collections:
            collection = _collection(scene, place, told["top"])
            if name not in collection.objects:
                collection.objects.link(bpy.data.objects[name])
    scene.camera = bpy.data.objects.get(told["camera"] or "")
    scene.world = bpy.data.worlds.get(told["world"] or "")
    layer = bpy.context.view_layer
    for name in told["selected"]:
        if name in layer.objects:
            layer.objects[name].select_set(True)
    layer.objects.active = layer.objects.get(told["active"] or "")
    scene.frame_set(told["frame"])
    return {"objects": len(bpy.data.objects)}


def _with_needs(chosen):
    """The data-blocks, and those that they use, directly or not."""
    uses = {}
    for block, users in bpy.data.user_map().items():
        for user in users:
            uses.setdefault(user, []).append(block)
    found, waiting = set(chosen), list(chosen)
    while waiting:
        for block in uses.get(waiting.pop(), ()):
            if block not in found:
                found.add(block)
                waiting.append(block)
    return found


def _collection(scene, name, top):
    if name == top:
        return scene.collection
    found = bpy.data.collections.get(name)
    if found is None:
        found = bpy.data.collections.new(name)
    if found.name not in scene.collection.children and not any(
        found.name in other.children for other in bpy.data.collections
    ):
        scene.collection.children.link(found)
    return found


def _plain(value):
    return list(value) if hasattr(value, "__len__") else value
