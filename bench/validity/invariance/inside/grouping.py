# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups and names: hierarchies and collections dissolved, or made where there are none; things called otherwise."""

import bpy
import numpy

_SAME = 1e-6


def ungroup(cast):
    """Dissolves hierarchies that carry nothing, and collections that are there to group. The largest part of what was
    named by its group gets the name.
    """
    things = list(bpy.context.scene.objects)
    carriers = _moving({thing.parent for thing in things if thing.parent is not None})
    changed = [thing for thing in things if thing.parent is not None and thing.parent not in carriers]
    for thing in changed:
        matrix = thing.matrix_world.copy()
        thing.parent = None
        thing.matrix_world = matrix
    changed += _out_of_collections(things)
    for actor in cast:
        for unit in actor["units"]:
            _pass_name_on(unit)
    return len(set(changed))


def group(cast):
    """Puts what stands for each actor into a collection of its name; the objects themselves are called nothing."""
    _out_of_collections(bpy.context.scene.objects)
    number = 0
    for actor in cast:
        names = [*(name for unit in actor["units"] for name in unit), *actor["parts"]]
        things = [bpy.data.objects[name] for name in names]
        made = bpy.data.collections.new(actor["name"])
        bpy.context.scene.collection.children.link(made)
        for thing in things:
            number += 1
            bpy.context.scene.collection.objects.unlink(thing)
            made.objects.link(thing)
            _call(thing, f"Mesh.{number:03d}")
    return number


def rename(cast):
    """Calls each actor otherwise, and what else there is nothing in particular."""
    changed = 0
    for actor in cast:
        style = _STYLES[changed % len(_STYLES)]
        for number, unit in enumerate(actor["units"], 1):
            for name in unit:
                changed += 1
                _call(bpy.data.objects[name], style(actor["other"], number))
        collection = bpy.data.collections.get(actor["name"])
        if collection is not None:
            collection.name = actor["other"]
    return changed


_STYLES = (
    lambda name, number: f"{name.replace(' ', '_')}_{number:02d}",
    lambda name, number: f"{name.title().replace(' ', '').replace('-', '')}.{number:03d}",
    lambda name, number: f"{name.upper()} {number}",
)


def _call(thing, name):
    thing.name = name
    if thing.data is not None:
        thing.data.name = name


def _pass_name_on(unit):
    """Where an empty bore the name of a thing: its largest mesh bears it, and the empty is gone."""
    bearer = bpy.data.objects.get(unit[0])
    if bearer is None or not _only_groups(bearer):
        return
    parts = [bpy.data.objects[each] for each in unit[1:] if bpy.data.objects[each].type == "MESH"]
    if parts:
        called = bearer.name
        bpy.data.objects.remove(bearer)
        max(parts, key=lambda thing: thing.dimensions.length).name = called


def _only_groups(thing):
    """Whether it is an empty that neither shows, pushes nor ties anything, and has nothing on it any more."""
    return (
        thing.type == "EMPTY"
        and thing.instance_type == "NONE"
        and (thing.field is None or thing.field.type == "NONE")
        and thing.rigid_body_constraint is None
        and not thing.children
    )


def _moving(things):
    """Those of these objects that are not always in the same place."""
    scene = bpy.context.scene
    first, last = scene.frame_start, scene.frame_end
    seen = {thing: [] for thing in things}
    for frame in (first, (first + last) // 2, last):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for thing, poses in seen.items():
            poses.append(numpy.array(thing.evaluated_get(graph).matrix_world))
    scene.frame_set(first)
    return {
        thing
        for thing, poses in seen.items()
        if not all(numpy.allclose(pose, poses[0], rtol=0, atol=_SAME) for pose in poses)
    }


def _out_of_collections(things):
    """Takes objects out of collections that only group. Returns those that were in one."""
    needed = _needed_collections()
    root = bpy.context.scene.collection
    changed = []
    for thing in list(things):
        grouping = [each for each in thing.users_collection if each is not root and each not in needed]
        if grouping and root not in thing.users_collection:
            root.objects.link(thing)
        for each in grouping:
            each.objects.unlink(thing)
            changed.append(thing)
    return changed


def _needed_collections():
    """Collections that physics or instances refer to."""
    found = set()
    scene = bpy.context.scene
    if scene.rigidbody_world is not None:
        found |= {scene.rigidbody_world.collection, scene.rigidbody_world.constraints}
    for thing in bpy.data.objects:
        found.add(thing.instance_collection)
        for modifier in thing.modifiers:
            for block in (modifier, *(getattr(modifier, name, None) for name in _SETTINGS)):
                found |= _collections_of(block)
    for settings in bpy.data.particles:
        found |= _collections_of(settings) | _collections_of(settings.effector_weights)
    return found - {None}


_SETTINGS = ("settings", "collision_settings", "domain_settings")


def _collections_of(block):
    """The collections that a block of settings names, and its weights of fields."""
    if block is None:
        return set()
    found = {getattr(block, each.identifier) for each in block.bl_rna.properties if _names_collection(each)}
    weights = getattr(block, "effector_weights", None)
    return found | ({weights.collection} if weights is not None else set())


def _names_collection(one):
    return one.type == "POINTER" and one.fixed_type.identifier == "Collection"
