# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of objects: their visibility, modifiers and force fields."""

import bpy

from .lookup import modifiers_of, mute_keys, split


def hide_in_render(objects):
    """Hides objects in renders."""
    for obj in objects:
        obj.hide_render = True
    return objects


def switch_off(objects, types, where="show_render", kind=None):
    """Switches modifiers off, in renders or (``show_viewport``) in the viewport."""
    pairs = modifiers_of(objects, types, kind)
    for _, modifier in pairs:
        setattr(modifier, where, False)
    return [obj for obj, _ in pairs]


def remove_modifier(objects, types, kind=None):
    """Removes modifiers."""
    pairs = [(obj, modifier.name) for obj, modifier in modifiers_of(objects, types, kind)]
    for obj, name in pairs:
        obj.modifiers.remove(obj.modifiers[name])
    return [obj for obj, _ in pairs]


def move_first(objects, types):
    """Moves modifiers to the top of the stack, so that they get the undeformed mesh."""
    pairs = modifiers_of(objects, types)
    for obj, modifier in pairs:
        obj.modifiers.move(obj.modifiers.find(modifier.name), 0)
    return [obj for obj, _ in pairs]


def set_value(objects, types, path, value, kind=None):
    """Sets a setting of modifiers to another value."""
    changed = []
    for obj, modifier in modifiers_of(objects, types, kind):
        block, attribute = split(modifier, path)
        if getattr(block, attribute) != value:
            setattr(block, attribute, value)
            changed.append(obj)
    return changed


def clear_group(objects, types, path):
    """Removes all points from the vertex group that a setting names; the group stays."""
    changed = []
    for obj, modifier in modifiers_of(objects, types):
        block, attribute = split(modifier, path)
        group = obj.vertex_groups.get(getattr(block, attribute))
        if group is not None:
            group.remove(range(len(obj.data.vertices)))
            changed.append(obj)
    return changed


def collide_with_nothing(objects, types, path):
    """Limits collisions of modifiers to an empty collection."""
    pairs = modifiers_of(objects, types)
    nothing = bpy.data.collections.new("Nothing")
    bpy.context.scene.collection.children.link(
        nothing
    )  # cloth does not count as a user: it would not be saved
    for _, modifier in pairs:
        block, attribute = split(modifier, path)
        setattr(block, attribute, nothing)
    return [obj for obj, _ in pairs]


def remove_field_strength(objects):
    """Sets the strength of force fields to 0: of these objects, or of all."""
    fields = [obj for obj in objects or bpy.context.scene.objects if obj.field and obj.field.type != "NONE"]
    for obj in fields:
        mute_keys(obj, "field.strength")
        obj.field.strength = 0.0
    return fields
