# SPDX-License-Identifier: GPL-3.0-or-later
"""Rings with names around objects, drawn over the 3D views. They are no part of the file: nothing has to be undone."""

import math

import blf
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader
from mathutils import Vector

_COLOUR = (1.0, 0.35, 0.0, 1.0)
_POINTS = 64
_WIDTH = 3.0
_LETTERS = 16  # pixels
_ROOM = 1.15  # how much larger than the object a ring is
_SMALLEST = 12.0
_shown = {"names": [], "handle": None}


def set_marks(names):
    """Draws rings around the objects of these names from now on; none removes them. Returns how many there were."""
    before = len(_shown["names"])
    _shown["names"] = list(names)
    if names and _shown["handle"] is None:
        _shown["handle"] = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
    elif not names and _shown["handle"] is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_shown["handle"], "WINDOW")
        _shown["handle"] = None
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
    return before


def _draw():
    """Blender calls this for each 3D view that it draws."""
    region, view = bpy.context.region, bpy.context.region_data
    for name in _shown["names"]:
        obj = bpy.data.objects.get(name)
        if obj is None or view is None:
            continue
        corners = [obj.matrix_world @ Vector(corner) for corner in obj.bound_box]
        middle = sum(corners, Vector()) / len(corners)
        at = location_3d_to_region_2d(region, view, middle)
        ends = [
            end for corner in corners if (end := location_3d_to_region_2d(region, view, corner)) is not None
        ]
        if at is None or not ends:
            continue
        radius = max(_SMALLEST, _ROOM * max((end - at).length for end in ends))
        _draw_ring(at, radius)
        blf.position(0, at.x + radius * math.sqrt(0.5) + 6, at.y + radius * math.sqrt(0.5) + 6, 0)
        _set_size(_LETTERS)
        blf.color(0, *_COLOUR)
        blf.draw(0, name)


def _draw_ring(at, radius):
    steps = [2 * math.pi * number / _POINTS for number in range(_POINTS + 1)]
    points = [(at.x + radius * math.cos(step), at.y + radius * math.sin(step), 0.0) for step in steps]
    shader = _line_shader()
    shader.bind()
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", _WIDTH)
    shader.uniform_float("color", _COLOUR)
    batch_for_shader(shader, "LINE_STRIP", {"pos": points}).draw(shader)


def _line_shader():
    try:
        return gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    except ValueError:  # its name before 3.4
        return gpu.shader.from_builtin("3D_POLYLINE_UNIFORM_COLOR")


def _set_size(pixels):
    if bpy.app.version < (4, 0, 0):
        blf.size(0, pixels, 72)  # pyright: ignore[reportCallIssue]
    else:
        blf.size(0, pixels)
