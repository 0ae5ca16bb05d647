# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds modes that RNA lists and nothing enters: those of what a version has no more, or not yet."""

import bpy

from ..apart import sent_apart
from ..instances.making import activate, choices, mesh_object, remove, scratch_scene
from .active_objects import modes, typed_object

# The properties that tell modes.
OF_CONTEXT, OF_OBJECT = "bpy.types.Context.mode", "bpy.types.Object.mode"
# Other names of one.
ALSO = {OF_CONTEXT: ("bpy.context.mode",)}


def hair_object():
    """A mesh object that can be combed."""
    obj = mesh_object()
    system = obj.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system
    system.settings.type = "HAIR"
    return obj


def enter_all(send):
    """Has an object of every type, and one with hair, enter each of its modes; sends both names of each mode.

    Sends the type of which there is no object instead: its modes are not known.
    """
    scratch_scene()
    makers = {kind: lambda kind=kind: typed_object(kind) for kind in choices("Object", "type")}
    for kind, make in {**makers, "hair": hair_object}.items():
        try:
            obj = make()
        except Exception:
            obj = None
        if obj is None:
            send({"unknown": kind})
            continue
        activate(obj)
        obj.select_set(True)
        for mode in modes(obj):
            send({OF_CONTEXT: bpy.context.mode, OF_OBJECT: mode})
        remove(obj)


def find_all(write):
    """One ``never_reached`` record for each property that has such modes. Wants a system that can work apart."""
    ended, rows = sent_apart(enter_all)
    if not ended or any("unknown" in row for row in rows):
        return
    for path in (OF_CONTEXT, OF_OBJECT):
        reached = {row[path] for row in rows}
        items = getattr(bpy.types, path.split(".")[2]).bl_rna.properties["mode"].enum_items
        never = [item.identifier for item in items if item.identifier not in reached]
        for name in (path, *ALSO.get(path, ())) if never else ():
            write("never_reached", path=name, items=never)
