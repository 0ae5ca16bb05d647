# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes one reference scene, bakes it and saves it: ``make.py -- SCENE FILE``. Its script lies beside this."""

import importlib
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
for folder in (HERE, os.path.join(os.path.dirname(os.path.dirname(HERE)), "inside")):
    if folder not in sys.path:
        sys.path.insert(0, folder)


def make(scene, path):
    """Builds what the script ``scene`` says, and saves it baked as ``path``."""
    import bpy
    import mantaflow
    import physics

    mantaflow.mend()
    importlib.import_module(scene).build()
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(
        filepath=path, check_existing=False, compress=True
    )  # caches lie beside the file
    physics.bake(f"//{os.path.basename(path).removesuffix('.blend')}_fluids")
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_mainfile(compress=True)


if __name__ == "__main__":
    make(*sys.argv[sys.argv.index("--") + 1 :][-2:])
    sys.stdout.flush()
    os._exit(0)  # Blender that has run a fluid aborts when it ends in the usual way
