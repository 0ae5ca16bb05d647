# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the file to audit. Nothing in it is executed, and nothing is written."""

import bpy

from simworlds.sandbox.inside.open_blend import open_blend
from simworlds.sandbox.inside.refusal import Refused


def open_file(path):
    """Opens ``path``. Returns ``objects``: how many it has. Raises Refused."""
    open_blend(path)
    saved, own = tuple(bpy.data.version)[:2], tuple(bpy.app.version)[:2]
    if saved > own:
        raise Refused(
            f"it was saved by Blender {saved[0]}.{saved[1]}, and this is Blender {own[0]}.{own[1]}, which cannot read "
            "all of it; choose a newer Blender"
        )
    if bpy.context.scene is None:
        raise Refused("it has no scene")
    return {"objects": len(bpy.data.objects)}
