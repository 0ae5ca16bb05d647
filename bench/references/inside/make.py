# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes one reference scene, bakes it and saves it."""

import importlib
import os
import sys

import bpy

from simworlds.sandbox.inside import mantaflow

from . import baking


def main(arguments):
    """``arguments``: the scene's id, whose script lies in ``scenes``, and the .blend to write."""
    scene, path = arguments
    mantaflow.mend()
    importlib.import_module(f".scenes.{scene}", __package__).build()
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(
        filepath=path, check_existing=False, compress=True
    )  # caches lie beside the file
    baking.bake(f"//{os.path.basename(path).removesuffix('.blend')}_fluids")
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_mainfile(compress=True)
    sys.stdout.flush()
    os._exit(0)  # Blender that has run a fluid aborts when it ends in the usual way
