# SPDX-License-Identifier: GPL-3.0-or-later
"""Rewrites of groups and names: dissolves or makes hierarchies and collections, renames objects."""

import bpy
import numpy

_SAME = 1e-6


def ungroup(actors):
    """Dissolves hierarchies that move nothing, and collections that only group. The largest mesh of a group gets the
    name of the group.
    """
    objects = list(bpy.context.scene.objects)
    carriers = _moving({obj.parent for obj in objects if obj.parent is not None})
    changed = [obj for obj in objects if obj.parent is not None and obj.parent not in carriers]
    for obj in changed:
        matrix = obj.matrix_world.copy()
        obj.parent = None
        obj.matrix_world = matrix
    changed += _out_of_collections(objects)
    for actor in actors:
        for unit in actor["units"]:
            _move_name_to_mesh(unit)
    return len(set(changed))


def group(actors):
    """Puts each actor's objects into a collection of its name; the objects get meaningless names."""
    _out_of_collections(bpy.context.scene.objects)
    number = 0
    for actor in actors:
        names = [*(name for unit in actor["units"] for name in unit), *actor["parts"]]
        objects = [bpy.data.objects[name] for name in names]
        collection = bpy.data.collections.new(actor["name"])
        bpy.context.scene.collection.children.link(collection)
        for obj in objects:
            number += 1
            bpy.context.scene.collection.objects.unlink(obj)
            collection.objects.link(obj)
            _rename(obj, f"Mesh.{number:03d}")
    return number


def rename(actors):
    """Renames each actor's objects and its collection to a synonym."""
    changed = 0
    for actor in actors:
        style = _STYLES[changed % len(_STYLES)]
        for number, unit in enumerate(actor["units"], 1):
            for name in unit:
                changed += 1
                _rename(bpy.data.objects[name], style(actor["other"], number))
        collection = bpy.data.collections.get(actor["name"])
        if collection is not None:
            collection.name = actor["other"]
    return changed


_STYLES = (
    lambda name, number: f"{name.replace(' ', '_')}_{number:02d}",
    lambda name, number: f"{name.title().replace(' ', '').replace('-', '')}.{number:03d}",
    lambda name, number: f"{name.upper()} {number}",
)


def _rename(obj, name):
    obj.name = name
    if obj.data is not None:
        obj.data.name = name


def _move_name_to_mesh(unit):
    """Where an empty had the name of an actor: removes it, and gives the name to the largest mesh."""
    bearer = bpy.data.objects.get(unit[0])
    if bearer is None or not _only_groups(bearer):
        return
    parts = [bpy.data.objects[each] for each in unit[1:] if bpy.data.objects[each].type == "MESH"]
    if parts:
        called = bearer.name
        bpy.data.objects.remove(bearer)
        max(parts, key=lambda obj: obj.dimensions.length).name = called


def _only_groups(obj):
    """Whether it is an empty without instances, force field, constraint or children."""
    return (
        obj.type == "EMPTY"
        and obj.instance_type == "NONE"
        and (obj.field is None or obj.field.type == "NONE")
        and obj.rigid_body_constraint is None
        and not obj.children
    )


def _moving(objects):
    """The objects that move."""
    scene = bpy.context.scene
    first, last = scene.frame_start, scene.frame_end
    seen = {obj: [] for obj in objects}
    for frame in (first, (first + last) // 2, last):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for obj, poses in seen.items():
            poses.append(numpy.array(obj.evaluated_get(graph).matrix_world))
    scene.frame_set(first)
    return {
        obj
        for obj, poses in seen.items()
        if not all(numpy.allclose(pose, poses[0], rtol=0, atol=_SAME) for pose in poses)
    }


def _out_of_collections(objects):
    """Removes objects from collections that only group. Returns those that were in one."""
    needed = _needed_collections()
    root = bpy.context.scene.collection
    changed = []
    for obj in list(objects):
        grouping = [each for each in obj.users_collection if each is not root and each not in needed]
        if grouping and root not in obj.users_collection:
            root.objects.link(obj)
        for each in grouping:
            each.objects.unlink(obj)
            changed.append(obj)
    return changed


def _needed_collections():
    """Collections that physics or instances refer to."""
    needed = set()
    scene = bpy.context.scene
    if scene.rigidbody_world is not None:
        needed |= {scene.rigidbody_world.collection, scene.rigidbody_world.constraints}
    for obj in bpy.data.objects:
        needed.add(obj.instance_collection)
        for modifier in obj.modifiers:
            for block in (modifier, *(getattr(modifier, name, None) for name in _SETTINGS)):
                needed |= _collections_of(block)
    for settings in bpy.data.particles:
        needed |= _collections_of(settings) | _collections_of(settings.effector_weights)
    return needed - {None}


_SETTINGS = ("settings", "collision_settings", "domain_settings")


def _collections_of(block):
    """The collections that a block of settings names, and its weights of fields."""
    if block is None:
        return set()
    collections = {
        getattr(block, each.identifier) for each in block.bl_rna.properties if _names_collection(each)
    }
    weights = getattr(block, "effector_weights", None)
    return collections | ({weights.collection} if weights is not None else set())


def _names_collection(prop):
    return prop.type == "POINTER" and prop.fixed_type.identifier == "Collection"
