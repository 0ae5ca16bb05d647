# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of rigid bodies, of what ties them, and of their world."""

import bpy

from .lookup import mute_keys

_SHAPES = ("MESH", "BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL")


def set_body(things, attribute, value):
    """Gives a setting of rigid bodies another value."""
    found = _bodies(things)
    for thing in found:
        setattr(thing.rigid_body, attribute, value)
    return found


def turn_type(things):
    """Makes active bodies passive, and passive ones active."""
    found = _bodies(things)
    for thing in found:
        thing.rigid_body.type = "PASSIVE" if thing.rigid_body.type == "ACTIVE" else "ACTIVE"
    return found


def grab(things):
    """Has active bodies follow their keys from the first frame to the last: whatever would let them go is muted."""
    found = [thing for thing in _bodies(things) if thing.rigid_body.type == "ACTIVE"]
    for thing in found:
        mute_keys(thing, "rigid_body.kinematic")
        thing.rigid_body.kinematic = True
    return found


def other_shape(things, shapes):
    """Has bodies collide as something that they are not: a mesh, or else a shape that is none of ``shapes``."""
    found = _bodies(things)
    for thing in found:
        thing.rigid_body.collision_shape = next(shape for shape in _SHAPES if shape not in shapes)
    return found


def remove_body(things):
    """Makes bodies things again that nothing simulates."""
    found = _bodies(things)
    for thing in found:
        bpy.context.view_layer.objects.active = thing
        bpy.ops.rigidbody.object_remove()
    return found


def expel(things, count=None):
    """Takes bodies out of the world, which keep their settings: these, or (``count``) so many of all, these first."""
    world = bpy.context.scene.rigidbody_world.collection
    found = [thing for thing in _bodies(things) if thing.name in world.objects]
    if count is not None:
        found = [*found, *(thing for thing in world.objects if thing not in found)][:count]
    for thing in found:
        world.objects.unlink(thing)
    return found


def switch_off_world(things):
    """Keeps the world from being simulated."""
    del things
    bpy.context.scene.rigidbody_world.enabled = False
    return _bodies(bpy.context.scene.objects)


def untie(things):
    """Takes one end off whatever ties these bodies."""
    found = _ties(things)
    for thing in found:
        thing.rigid_body_constraint.object2 = None
    return found


def let_collide(things):
    """Lets bodies collide with what they are tied to."""
    found = _ties(things)
    for thing in found:
        thing.rigid_body_constraint.disable_collisions = False
    return found


def _bodies(things):
    return [thing for thing in things if thing.rigid_body is not None]


def _ties(things):
    """The objects with constraints of these bodies."""
    found = []
    for thing in bpy.context.scene.objects:
        tie = thing.rigid_body_constraint
        if tie is not None and ({thing, tie.object1, tie.object2} & set(things)):
            found.append(thing)
    return found
