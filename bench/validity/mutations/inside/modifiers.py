# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of objects' modifiers and their settings."""

import bpy

from .lookup import modifiers_of, split


def hide(things):
    """Keeps them out of renders."""
    for thing in things:
        thing.hide_render = True
    return things


def mute(things, types, where="show_render", kind=None):
    """Switches modifiers off, in renders or (``show_viewport``) in the viewport."""
    found = modifiers_of(things, types, kind)
    for _, modifier in found:
        setattr(modifier, where, False)
    return [thing for thing, _ in found]


def remove(things, types, kind=None):
    """Takes modifiers away."""
    found = [(thing, modifier.name) for thing, modifier in modifiers_of(things, types, kind)]
    for thing, name in found:
        thing.modifiers.remove(thing.modifiers[name])
    return [thing for thing, _ in found]


def put_first(things, types):
    """Puts modifiers before all others, so that they get the surface as it was modelled."""
    found = modifiers_of(things, types)
    for thing, modifier in found:
        thing.modifiers.move(thing.modifiers.find(modifier.name), 0)
    return [thing for thing, _ in found]


def set_value(things, types, path, value, kind=None):
    """Gives a setting of modifiers another value."""
    changed = []
    for thing, modifier in modifiers_of(things, types, kind):
        block, attribute = split(modifier, path)
        if getattr(block, attribute) != value:
            setattr(block, attribute, value)
            changed.append(thing)
    return changed


def clear_group(things, types, path):
    """Takes all weights out of the vertex group that a setting names; the group stays."""
    changed = []
    for thing, modifier in modifiers_of(things, types):
        block, attribute = split(modifier, path)
        group = thing.vertex_groups.get(getattr(block, attribute))
        if group is not None:
            group.remove(range(len(thing.data.vertices)))
            changed.append(thing)
    return changed


def spare(things, types, path):
    """Limits what modifiers collide with to a collection that is empty."""
    found = modifiers_of(things, types)
    nothing = bpy.data.collections.new("Nothing")
    bpy.context.scene.collection.children.link(
        nothing
    )  # cloth does not count as a user: it would not be saved
    for _, modifier in found:
        block, attribute = split(modifier, path)
        setattr(block, attribute, nothing)
    return [thing for thing, _ in found]
