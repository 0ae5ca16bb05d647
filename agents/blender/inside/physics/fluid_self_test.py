# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks whether this Blender can simulate fluids, by baking a drop of liquid."""

import os
import shutil
import tempfile

import bpy

from simworlds.sandbox.inside import mantaflow


def self_test(arguments, report):
    """Bakes a drop of liquid in the open file, which it replaces; for a process that has simulated no fluid yet.

    ``remedy``: whether the fix for Mantaflow may be applied; without it, a bpy that needs it aborts. Returns the
    ``version``, whether this Blender gets the fix (``hooked``), and whether liquid was simulated (``works``).
    """
    mantaflow.withhold(not arguments["remedy"])
    folder = tempfile.mkdtemp(prefix="fluid-")
    try:
        report(0, None, "baking a drop of liquid")
        return {
            "version": bpy.app.version_string,
            "hooked": mantaflow.is_hooked(),
            "works": _bake_drop(folder),
        }
    finally:
        mantaflow.withhold(False)
        shutil.rmtree(folder, ignore_errors=True)


def _bake_drop(folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.5)
    drop = bpy.context.object.modifiers.new("Fluid", "FLUID")
    drop.fluid_type = "FLOW"
    drop.flow_settings.flow_type = "LIQUID"
    bpy.ops.mesh.primitive_cube_add(size=2)
    owner = bpy.context.object
    modifier = owner.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.use_mesh = "LIQUID", 16, True
    domain.cache_type, domain.cache_frame_end = "ALL", 2
    domain.cache_directory = os.path.join(folder, "cache")
    bpy.ops.fluid.bake_all()
    bpy.context.scene.frame_set(2)
    graph = bpy.context.evaluated_depsgraph_get()
    # Without liquid Blender shows the domain's own mesh.
    return len(owner.evaluated_get(graph).data.vertices) > len(owner.data.vertices)
