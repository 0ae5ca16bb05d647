# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes put together or shown from elsewhere: of things that nothing simulates and that do not move."""

import bpy


def join(cast):
    """Makes one mesh of what is several: of each still thing's parts, and of still things of one kind."""
    changed = 0
    for actor in cast:
        things = [bpy.data.objects[name] for unit in actor["units"] for name in unit]
        parts = [thing for thing in things if thing.type == "MESH"]
        if not actor["still"] or len(parts) < 2 or not _are_plain(things):
            continue
        bpy.ops.object.select_all(action="DESELECT")
        for thing in parts:
            if thing.data.users > 1:
                thing.data = thing.data.copy()
            thing.select_set(True)
        bpy.context.view_layer.objects.active = parts[0]
        bpy.ops.object.join()
        changed += len(parts)
    return changed


def instance(cast):
    """Shows still things as instances of collections that lie outside of the scene."""
    changed = 0
    for actor in cast:
        for unit in actor["units"] if actor["still"] else ():
            things = [bpy.data.objects[name] for name in unit]
            if _are_plain(things):
                _show(things, unit[0])
                changed += 1
    return changed


def _show(things, name):
    parts = bpy.data.collections.new(f"{name} parts")
    for thing in things:
        for each in list(thing.users_collection):
            each.objects.unlink(thing)
        parts.objects.link(thing)
    things[0].name = f"{name} itself"
    shown = bpy.data.objects.new(name, None)
    shown.instance_type, shown.instance_collection = "COLLECTION", parts
    bpy.context.scene.collection.objects.link(shown)


def _are_plain(things):
    """Whether these are meshes, and empties that group them, which nothing moves and nothing else has to do with."""
    return all(
        thing.type in {"MESH", "EMPTY"}
        and not thing.modifiers
        and not thing.constraints
        and thing.rigid_body is None
        and thing.rigid_body_constraint is None
        and thing.animation_data is None
        and thing.instance_type == "NONE"
        and (thing.parent is None or thing.parent in things)
        and all(child in things for child in thing.children)
        for thing in things
    )
