# SPDX-License-Identifier: GPL-3.0-or-later
"""Rewrites of meshes that are neither simulated nor moved: joined, or shown as instances."""

import bpy


def join(actors):
    """Joins the meshes of each static actor."""
    changed = 0
    for actor in actors:
        objects = [bpy.data.objects[name] for unit in actor["units"] for name in unit]
        parts = [obj for obj in objects if obj.type == "MESH"]
        if not actor["still"] or len(parts) < 2 or not _are_plain(objects):
            continue
        bpy.ops.object.select_all(action="DESELECT")
        for obj in parts:
            if obj.data.users > 1:
                obj.data = obj.data.copy()
            obj.select_set(True)
        bpy.context.view_layer.objects.active = parts[0]
        bpy.ops.object.join()
        changed += len(parts)
    return changed


def instance(actors):
    """Shows static actors as instances of collections outside of the scene."""
    changed = 0
    for actor in actors:
        for unit in actor["units"] if actor["still"] else ():
            objects = [bpy.data.objects[name] for name in unit]
            if _are_plain(objects):
                _show(objects, unit[0])
                changed += 1
    return changed


def _show(objects, name):
    parts = bpy.data.collections.new(f"{name} parts")
    for obj in objects:
        for each in list(obj.users_collection):
            each.objects.unlink(obj)
        parts.objects.link(obj)
    objects[0].name = f"{name} itself"
    instance = bpy.data.objects.new(name, None)
    instance.instance_type, instance.instance_collection = "COLLECTION", parts
    bpy.context.scene.collection.objects.link(instance)


def _are_plain(objects):
    """Whether these are static meshes, and empties that group them, to which nothing else is related."""
    return all(
        obj.type in {"MESH", "EMPTY"}
        and not obj.modifiers
        and not obj.constraints
        and obj.rigid_body is None
        and obj.rigid_body_constraint is None
        and obj.animation_data is None
        and obj.instance_type == "NONE"
        and (obj.parent is None or obj.parent in objects)
        and all(child in objects for child in obj.children)
        for obj in objects
    )
