# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of rigid bodies, their constraints, and their world."""

import bpy

from .lookup import mute_keys

_SHAPES = ("MESH", "BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL")


def set_body(objects, attribute, value):
    """Sets a setting of rigid bodies to another value."""
    bodies = _bodies(objects)
    for obj in bodies:
        setattr(obj.rigid_body, attribute, value)
    return bodies


def swap_body_type(objects):
    """Makes active bodies passive, and passive ones active."""
    bodies = _bodies(objects)
    for obj in bodies:
        obj.rigid_body.type = "PASSIVE" if obj.rigid_body.type == "ACTIVE" else "ACTIVE"
    return bodies


def keep_kinematic(objects):
    """Makes active bodies kinematic for the whole clip; keys that would release them are muted."""
    bodies = [obj for obj in _bodies(objects) if obj.rigid_body.type == "ACTIVE"]
    for obj in bodies:
        mute_keys(obj, "rigid_body.kinematic")
        obj.rigid_body.kinematic = True
    return bodies


def change_shape(objects, shapes):
    """Gives bodies a collision shape that is not in ``shapes``."""
    bodies = _bodies(objects)
    for obj in bodies:
        obj.rigid_body.collision_shape = next(shape for shape in _SHAPES if shape not in shapes)
    return bodies


def remove_body(objects):
    """Removes the rigid bodies of objects."""
    bodies = _bodies(objects)
    for obj in bodies:
        bpy.context.view_layer.objects.active = obj
        bpy.ops.rigidbody.object_remove()
    return bodies


def remove_from_world(objects, count=None):
    """Removes bodies from the world, which keep their settings: these, or ``count`` of all, these first."""
    world = bpy.context.scene.rigidbody_world.collection
    bodies = [obj for obj in _bodies(objects) if obj.name in world.objects]
    if count is not None:
        bodies = [*bodies, *(obj for obj in world.objects if obj not in bodies)][:count]
    for obj in bodies:
        world.objects.unlink(obj)
    return bodies


def switch_off_world(objects):
    """Disables the rigid-body world."""
    del objects
    bpy.context.scene.rigidbody_world.enabled = False
    return _bodies(bpy.context.scene.objects)


def detach_constraint(objects):
    """Clears the second object of these bodies' constraints."""
    constraints = _ties(objects)
    for obj in constraints:
        obj.rigid_body_constraint.object2 = None
    return constraints


def enable_constraint_collisions(objects):
    """Lets constrained bodies collide with each other."""
    constraints = _ties(objects)
    for obj in constraints:
        obj.rigid_body_constraint.disable_collisions = False
    return constraints


def _bodies(objects):
    return [obj for obj in objects if obj.rigid_body is not None]


def _ties(objects):
    """The objects that have constraints of these bodies."""
    constraints = []
    for obj in bpy.context.scene.objects:
        constraint = obj.rigid_body_constraint
        if constraint is not None and ({obj, constraint.object1, constraint.object2} & set(objects)):
            constraints.append(obj)
    return constraints
