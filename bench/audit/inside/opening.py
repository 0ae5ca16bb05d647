# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the file that is to be audited. Nothing in it is executed, and nothing is written."""

import os

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .json_values import text


def open_file(path):
    """Opens ``path``. Returns ``objects``, how many there are. Raises Refused."""
    name = os.path.basename(path)
    try:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        said = " ".join(str(error).replace(path, name).split()).removeprefix("Error: ")
        raise Refused(f"{text(name)} cannot be opened: {text(said)[:300]}") from None
    saved, own = tuple(bpy.data.version)[:2], tuple(bpy.app.version)[:2]
    if saved > own:
        raise Refused(
            f"it was saved by Blender {saved[0]}.{saved[1]}, and this is {own[0]}.{own[1]}, which loses what the newer "
            "one added; name a newer Blender"
        )
    if bpy.context.scene is None:
        raise Refused("there is no scene in it")
    return {"objects": len(bpy.data.objects)}
