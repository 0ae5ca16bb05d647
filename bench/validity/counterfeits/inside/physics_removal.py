# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes all physics from the open scene: solvers, collisions, rigid bodies and their world, fields, bakes."""

import bpy

PHYSICS = {
    "CLOTH", "SOFT_BODY", "FLUID", "PARTICLE_SYSTEM", "PARTICLE_INSTANCE", "COLLISION", "DYNAMIC_PAINT", "EXPLODE",
    "OCEAN",
}  # fmt: skip


def remove_physics():
    """Removes all physics."""
    scene = bpy.context.scene
    for obj in list(scene.objects):
        for modifier in [each for each in obj.modifiers if each.type in PHYSICS]:
            obj.modifiers.remove(modifier)
        if obj.field is not None and obj.field.type != "NONE":
            obj.field.type = "NONE"
        if obj.rigid_body is not None:
            _with_active(obj, bpy.ops.rigidbody.object_remove)
        if obj.rigid_body_constraint is not None:
            _with_active(obj, bpy.ops.rigidbody.constraint_remove)
    if scene.rigidbody_world is not None:
        bpy.ops.rigidbody.world_remove()


def remove_visibly():
    """Removes all physics, and hides the boxes of fluid domains, which would be shown now."""
    for obj in bpy.context.scene.objects:
        if any(each.type == "FLUID" and each.fluid_type == "DOMAIN" for each in obj.modifiers):
            obj.hide_render = True
    remove_physics()


def _with_active(obj, operator):
    bpy.context.view_layer.objects.active = obj
    operator()
