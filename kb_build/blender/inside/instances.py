# SPDX-License-Identifier: GPL-3.0-or-later
"""Enumerations that only an instance can list (colour management's views and looks, render engines, …)."""

import re

import bpy

DEPTH = 3
# Up to Blender 4.3 it claims to be a Paint, which it is not in memory: reading what it inherits crashes.
UNREADABLE = frozenset({"UvSculpt"})


def refused_value_items(owner, name):
    """An enum's items as Blender names them when it refuses a value that cannot be one of them."""
    try:
        setattr(owner, name, "\x01")
    except TypeError as refusal:
        return re.findall(r"'([^']*)'", str(refusal).partition("not found in")[2])
    except (AttributeError, RuntimeError):
        pass
    return []


def reachable(root, depth):
    """The data behind a scene's or object's pointers, each class once."""
    queue, seen = [(root, depth)], set(UNREADABLE)
    while queue:
        owner, left = queue.pop(0)
        if owner.bl_rna.identifier in seen:
            continue
        seen.add(owner.bl_rna.identifier)
        yield owner
        if left:
            for prop in owner.bl_rna.properties:
                if prop.type == "POINTER" and prop.identifier != "rna_type":
                    value = getattr(owner, prop.identifier, None)
                    if isinstance(value, bpy.types.bpy_struct):
                        queue.append((value, left - 1))


def declaring_class(rna, name):
    """The class that adds the property, seen from one of its descendants."""
    while rna.base is not None and name in rna.base.properties:
        rna = rna.base
    return rna.identifier


def write_all(write):
    """One ``enum_items`` record for each enumeration that RNA alone lists as empty, or as a lone placeholder."""
    context = bpy.context
    done = set()
    for root in (
        context.scene,
        context.object,
        context.view_layer,
        context.preferences,
        *bpy.data.materials[:1],
    ):
        if root is None:
            continue
        for owner in reachable(root, DEPTH):
            for prop in owner.bl_rna.properties:
                if (
                    prop.type != "ENUM"
                    or prop.is_readonly
                    or prop.is_enum_flag
                    or len(prop.enum_items_static) > 1
                ):
                    continue
                path = f"bpy.types.{declaring_class(owner.bl_rna, prop.identifier)}.{prop.identifier}"
                items = refused_value_items(owner, prop.identifier) if path not in done else []
                if items:
                    done.add(path)
                    write("enum_items", path=path, items=items)
