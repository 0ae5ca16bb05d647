# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the user something: goes to a frame, selects, moves their view, draws an annotation."""

import math

import bpy
from mathutils import Vector

from simworlds.sandbox.inside.refusal import Refused

from .user_state import largest_view, main_window, state

_LAYER = "SimWorlds"
_POINTS = 48
_WIDTH = 4


def show(arguments, report):
    """Goes to ``frame``, selects ``objects`` (names) if ``select``, and fits the largest 3D view to them if ``view``.

    Returns the state afterwards.
    """
    del report
    window = main_window()
    objects = [_object(window, name) for name in arguments["objects"]]
    if arguments["frame"] is not None:
        window.scene.frame_set(arguments["frame"])
    before = _selection(window)
    if objects:
        _select(window, objects)
        if arguments["view"]:
            _fit(window)
        if not arguments["select"]:
            _select(window, *before)
    return state()


def annotate(arguments, report):
    """Draws a ring with an annotation's pen around each of ``objects`` (names); with none, removes all such rings."""
    del report
    window = main_window()
    objects = [_object(window, name) for name in arguments["objects"]]
    if not objects:
        return {"rings": 0, "removed": _remove_layer(window.scene)}
    layer = _layer(window.scene)
    frame = layer.frames[0] if layer.frames else layer.frames.new(window.scene.frame_current)
    area = largest_view(window)
    turn = area.spaces.active.region_3d.view_rotation if area else None
    for obj in objects:
        corners = [obj.matrix_world @ Vector(corner) for corner in obj.bound_box]
        middle = sum(corners, Vector()) / len(corners)
        radius = max((corner - middle).length for corner in corners) * 1.1 or 0.5
        stroke = frame.strokes.new()
        stroke.display_mode = "3DSPACE"
        stroke.points.add(_POINTS + 1)
        for number, point in enumerate(stroke.points):
            angle = 2 * math.pi * number / _POINTS
            flat = Vector((math.cos(angle), math.sin(angle), 0.0)) * radius
            point.co = middle + (turn @ flat if turn else flat)
    return {"rings": len(objects), "removed": 0}


def _object(window, name):
    obj = window.view_layer.objects.get(name)
    if obj is None:
        raise Refused(f"There is no object {name!r} in the view layer {window.view_layer.name!r}.")
    if obj.hide_get(view_layer=window.view_layer) or not obj.visible_get(view_layer=window.view_layer):
        raise Refused(f"{name!r} is hidden, so it cannot be shown.")
    return obj


def _selection(window):
    layer = window.view_layer
    return [obj for obj in layer.objects if obj.select_get(view_layer=layer)], layer.objects.active


def _select(window, objects, active=None):
    layer = window.view_layer
    for obj in layer.objects:
        obj.select_set(obj in objects, view_layer=layer)
    if objects or active:
        layer.objects.active = active or objects[0]


def _fit(window):
    area = largest_view(window)
    if area is None:
        raise Refused("No 3D view is open in the window.")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        bpy.ops.view3d.view_selected()


# Annotations: Blender's name for them has changed.


def _owner(scene):
    return "annotation" if hasattr(scene, "annotation") else "grease_pencil"


def _blocks():
    return bpy.data.annotations if hasattr(bpy.data, "annotations") else bpy.data.grease_pencils


def _layer(scene):
    name = _owner(scene)
    block = getattr(scene, name)
    if block is None:
        block = _blocks().new("Annotations")
        setattr(scene, name, block)
    layer = block.layers.get(_LAYER)
    if layer is None:
        layer = block.layers.new(_LAYER, set_active=False)
        layer.thickness = _WIDTH
        layer.color = (1.0, 0.35, 0.0) if hasattr(layer, "color") else None
    return layer


def _remove_layer(scene):
    block = getattr(scene, _owner(scene))
    layer = block.layers.get(_LAYER) if block is not None else None
    if layer is None:
        return 0
    count = sum(len(frame.strokes) for frame in layer.frames)
    block.layers.remove(layer)
    return count
