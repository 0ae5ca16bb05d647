# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds items of enumerations that are taken only in some mode of the context, as a brush's in Sculpt Mode.

An object of each type enters each of its modes, and meanwhile every data-block is asked, with what belongs to it.
"""

import bpy

from ..apart import can_work_apart, sent_apart
from .assigning import refused_value_items
from .making import activate, block_makers, called, object_of, remove, scratch_scene
from .observations import Contexts

# The types of objects that have modes which others lack.
TYPES = ("MESH", "ARMATURE", "CURVE", "CURVES", "GREASEPENCIL", "GPENCIL")
MODE = "bpy.context.mode"


def blocks():
    """(what it is, data-block) of every type."""
    for _, collection, given in block_makers():
        try:
            block = collection.new("new", **given)
        except (TypeError, RuntimeError):
            continue
        yield called(block), block


def asked(observer, made):
    """(label, number of the struct among those of one thing, path) → the items that an enumeration takes now."""
    found = {}
    for label, block in made:
        for number, struct in enumerate(observer.parts(block)):
            for field in observer.layout(struct).enums:
                if observer.is_computed(field):
                    items = refused_value_items(struct, field.name, field.is_flag)
                    if items:
                        found[label, number, field.path] = tuple(items)
    return found


def modes(obj):
    """Puts an object into each of its other modes; yields what the context then calls them."""
    for item in obj.bl_rna.properties["mode"].enum_items:
        try:
            if item.identifier != "OBJECT":
                bpy.ops.object.mode_set(mode=item.identifier)
        except (TypeError, RuntimeError):
            continue
        if obj.mode != "OBJECT":
            yield bpy.context.mode
            bpy.ops.object.mode_set(mode="OBJECT")


def look(observer, send):
    """Sends what takes other items in a mode than outside of it."""
    scratch_scene()
    made = list(blocks())
    usual = asked(observer, made)
    for kind in TYPES:
        obj = object_of(kind)
        if obj is None:
            continue
        activate(obj)
        obj.select_set(True)
        for mode in modes(obj):
            for (label, number, path), items in asked(observer, made).items():
                if items != usual.get((label, number, path), items):
                    send({"path": path, "label": label, "mode": f"{MODE}={mode!r}", "items": items})
        remove(obj)


def find_all(observer):
    """Adds what was found to what the observer knows of enumerations. Wants a system that can work apart."""
    if not can_work_apart():
        return
    _, rows = sent_apart(lambda send: look(observer, send))
    for row in rows:
        contexts = observer.items.setdefault(row["path"], {}).setdefault(tuple(row["items"]), Contexts())
        contexts.add((row["label"], row["mode"]), {})
