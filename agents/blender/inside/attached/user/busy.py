# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user is in the middle of, so that nothing is changed under their hands."""

import contextlib
import ctypes
import struct

import bpy

from ..files import structures
from . import hold

_JOBS = {
    "RENDER": "renders",
    "COMPOSITE": "composites",
    "OBJECT_BAKE": "bakes textures",
    "OBJECT_BAKE_TEXTURE": "bakes textures",
    "OBJECT_SIM_OCEAN": "bakes an ocean",
    "OBJECT_SIM_FLUID": "bakes a fluid",
    "POINTCACHE": "bakes a simulation",
    "CALCULATE_SIMULATION_NODES": "bakes simulation nodes",
    "BAKE_GEOMETRY_NODES": "bakes geometry nodes",
}
_POINTER = struct.calcsize("P")
_MOST_HANDLERS = 64
# Of Blender's own structure for handlers, which no file describes: next, prev, type, flag, poll; then the operator.
_PREVIOUS, _TYPE, _OPERATOR = _POINTER, 2 * _POINTER, 4 * _POINTER
_OF_INTERFACE, _OF_OPERATORS = 2, 3  # others, for dropping files say, are there at all times


def reason(*, but_addons=False):
    """What the user or Blender is doing, with what to wait for; "" if nothing. ``but_addons``: modal operators of
    add-ons do not count: some run as long as Blender does."""
    for job, doing in _JOBS.items():
        with contextlib.suppress(TypeError, ValueError):  # this version has no such job
            if bpy.app.is_job_running(job):
                return f"Blender {doing}. Call again when that is done, or ask the user to press Esc"
    for window in bpy.context.window_manager.windows:
        for name in _modal(window):
            if not name:
                return "a menu or a field is open, or a slider is dragged. Call again when the user is done"
            if name == hold.NAME or (but_addons and _of_addon(name)):
                continue
            return f"{_title(name)} is running. Call again when the user has confirmed it or pressed Esc"
    return ""


def _modal(window):
    """The names of the modal operators of a window, "" for other things that take its events."""
    if hasattr(window, "modal_operators"):
        return [operator.bl_idname for operator in window.modal_operators]
    return _read_modal(window)


def _read_modal(window):
    """The same, where Blender tells it to nobody: before 4.2 it is read where Blender itself keeps it."""
    offset = structures.offset_of("wmWindow", "modalhandlers")
    name = structures.offset_of("wmOperator", "idname")
    if offset is None or name is None:
        return []
    found, before, handler = [], 0, _pointer(window.as_pointer() + offset)
    while handler and len(found) < _MOST_HANDLERS:
        if _pointer(handler + _PREVIOUS) != before:
            return []  # it is no list of handlers, so nothing in it is what it seems
        kind = ctypes.c_int.from_address(handler + _TYPE).value
        if kind == _OF_OPERATORS and (operator := _pointer(handler + _OPERATOR)):
            found.append(ctypes.string_at(operator + name, 64).split(b"\0")[0].decode("ascii", "replace"))
        elif kind == _OF_INTERFACE:
            found.append("")
        before, handler = handler, _pointer(handler)
    return found


def _pointer(address):
    return ctypes.c_void_p.from_address(address).value or 0


def _title(name):
    group, _, own = name.partition("_OT_")
    try:
        label = getattr(getattr(bpy.ops, group.lower()), own).get_rna_type().name
    except (AttributeError, KeyError, TypeError):
        label = name
    return f"the operator {label!r}"


def _of_addon(name):
    kind = getattr(bpy.types, name, None)
    return kind is not None and not str(getattr(kind, "__module__", "")).startswith(("bpy", "bl_"))
