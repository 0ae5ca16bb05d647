# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts the thread that USD keeps for as long as the process lives, before any call.

USD starts it with the first file that it opens, and a thread that a call leaves behind counts as a fault of that call.
"""

import contextlib
import os
import tempfile

import bpy


def start():
    """Opens an empty USD file. Where that fails, the first call that reads one ends Blender, and nothing is lost."""
    if not getattr(bpy.app.build_options, "usd", False):
        return
    with contextlib.suppress(RuntimeError, OSError, AttributeError), tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "empty.usda")
        with open(path, "w", encoding="ascii") as file:
            file.write("#usda 1.0\n")
        bpy.ops.wm.usd_import(filepath=path)
