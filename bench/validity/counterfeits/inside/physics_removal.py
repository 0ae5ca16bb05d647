# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes all physics out of the open scene: solvers, what they collide with, bodies and their world, fields, bakes."""

import bpy

PHYSICS = {
    "CLOTH", "SOFT_BODY", "FLUID", "PARTICLE_SYSTEM", "PARTICLE_INSTANCE", "COLLISION", "DYNAMIC_PAINT", "EXPLODE",
    "OCEAN",
}  # fmt: skip


def strip():
    """Leaves of the scene what no solver has a part in."""
    scene = bpy.context.scene
    for thing in list(scene.objects):
        for modifier in [each for each in thing.modifiers if each.type in PHYSICS]:
            thing.modifiers.remove(modifier)
        if thing.field is not None and thing.field.type != "NONE":
            thing.field.type = "NONE"
        if thing.rigid_body is not None:
            _with_active(thing, bpy.ops.rigidbody.object_remove)
        if thing.rigid_body_constraint is not None:
            _with_active(thing, bpy.ops.rigidbody.constraint_remove)
    if scene.rigidbody_world is not None:
        bpy.ops.rigidbody.world_remove()


def show_bare():
    """Leaves of the scene what there is without its physics; the box of what was fluid is not shown."""
    for thing in bpy.context.scene.objects:
        if any(each.type == "FLUID" and each.fluid_type == "DOMAIN" for each in thing.modifiers):
            thing.hide_render = True
    strip()


def _with_active(thing, operator):
    bpy.context.view_layer.objects.active = thing
    operator()
