# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes put together or shown from elsewhere: of things that nothing simulates and that do not move."""

import bpy


def join(cast):
    """Makes one mesh of what is several: of each still thing's parts, and of still things of one kind."""
    changed = 0
    for actor in cast:
        units = [[bpy.data.objects[name] for name in unit] for unit in actor["units"]]
        parts = [thing for unit in units for thing in unit if _is_plain(thing)]
        if not actor["still"] or len(parts) < 2 or len(parts) < sum(len(unit) for unit in units):
            continue
        bpy.ops.object.select_all(action="DESELECT")
        for thing in parts:
            _own_mesh(thing)
            thing.select_set(True)
        bpy.context.view_layer.objects.active = parts[0]
        bpy.ops.object.join()
        changed += len(parts)
    return changed


def instance(cast):
    """Shows still things as instances of collections that lie outside of the scene; gives alike meshes one data."""
    changed = 0
    for actor in cast:
        if not actor["still"]:
            continue
        for unit in actor["units"]:
            things = [bpy.data.objects[name] for name in unit]
            if all(_is_plain(thing) for thing in things):
                _show(things, unit[0])
                changed += 1
    return changed


def _show(things, name):
    parts = bpy.data.collections.new(f"{name} parts")
    for thing in things:
        for each in list(thing.users_collection):
            each.objects.unlink(thing)
        parts.objects.link(thing)
    things[0].name = f"{name} mesh"
    shown = bpy.data.objects.new(name, None)
    shown.name = name
    shown.instance_type, shown.instance_collection = "COLLECTION", parts
    bpy.context.scene.collection.objects.link(shown)


def _is_plain(thing):
    """Whether it is a mesh that nothing moves and nothing else has to do with."""
    return (
        thing.type == "MESH"
        and not thing.modifiers
        and thing.rigid_body is None
        and thing.animation_data is None
        and thing.parent is None
        and not thing.children
        and not thing.constraints
    )


def _own_mesh(thing):
    if thing.data.users > 1:
        thing.data = thing.data.copy()
