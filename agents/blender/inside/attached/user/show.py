# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the user something: goes to a frame, selects, moves their view, marks objects."""

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..user_state import largest_view, main_window, state
from . import marks


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


def mark(arguments, report):
    """Draws a ring around each of ``objects`` (names), over the 3D views; with none, removes all rings."""
    del report
    window = main_window()
    names = [_object(window, name).name for name in arguments["objects"]]
    before = marks.set_marks(names)
    return {"rings": len(names), "removed": 0 if names else before}


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
