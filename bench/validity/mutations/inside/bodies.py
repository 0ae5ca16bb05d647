# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of rigid bodies, their constraints, and their world."""

import bpy

from .lookup import mute_keys

_SHAPES = ("MESH", "BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL")


def set_body(objects, attribute, value):
    """Sets a setting of rigid bodies to another value."""
    found = _bodies(objects)
    for obj in found:
        setattr(obj.rigid_body, attribute, value)
    return found


def swap_body_type(objects):
    """Makes active bodies passive, and passive ones active."""
    found = _bodies(objects)
    for obj in found:
        obj.rigid_body.type = "PASSIVE" if obj.rigid_body.type == "ACTIVE" else "ACTIVE"
    return found


def keep_kinematic(objects):
    """Makes active bodies kinematic for the whole clip; keys that would release them are muted."""
    found = [obj for obj in _bodies(objects) if obj.rigid_body.type == "ACTIVE"]
    for obj in found:
        mute_keys(obj, "rigid_body.kinematic")
        obj.rigid_body.kinematic = True
    return found


def change_shape(objects, shapes):
    """Gives bodies a collision shape that is not in ``shapes``."""
    found = _bodies(objects)
    for obj in found:
        obj.rigid_body.collision_shape = next(shape for shape in _SHAPES if shape not in shapes)
    return found


def remove_body(objects):
    """Removes the rigid bodies of objects."""
    found = _bodies(objects)
    for obj in found:
        bpy.context.view_layer.objects.active = obj
        bpy.ops.rigidbody.object_remove()
    return found


def remove_from_world(objects, count=None):
    """Removes bodies from the world, which keep their settings: these, or ``count`` of all, these first."""
    world = bpy.context.scene.rigidbody_world.collection
    found = [obj for obj in _bodies(objects) if obj.name in world.objects]
    if count is not None:
        found = [*found, *(obj for obj in world.objects if obj not in found)][:count]
    for obj in found:
        world.objects.unlink(obj)
    return found


def switch_off_world(objects):
    """Disables the rigid-body world."""
    del objects
    bpy.context.scene.rigidbody_world.enabled = False
    return _bodies(bpy.context.scene.objects)


def detach_constraint(objects):
    """Clears the second object of these bodies' constraints."""
    found = _ties(objects)
    for obj in found:
        obj.rigid_body_constraint.object2 = None
    return found


def enable_constraint_collisions(objects):
    """Lets constrained bodies collide with each other."""
    found = _ties(objects)
    for obj in found:
        obj.rigid_body_constraint.disable_collisions = False
    return found


def _bodies(objects):
    return [obj for obj in objects if obj.rigid_body is not None]


def _ties(objects):
    """The objects that have constraints of these bodies."""
    found = []
    for obj in bpy.context.scene.objects:
        tie = obj.rigid_body_constraint
        if tie is not None and ({obj, tie.object1, tie.object2} & set(objects)):
            found.append(obj)
    return found
