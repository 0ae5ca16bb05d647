# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes data-blocks into a .blend of their own."""

import bpy


def write(path, blocks, **how):
    """As ``bpy.data.libraries.write``; ``blocks`` may be empty, of which Blender 4.2 crashes."""
    if blocks:
        bpy.data.libraries.write(path, blocks, **how)
        return
    nothing = bpy.data.texts.new("nothing")
    try:
        bpy.data.libraries.write(path, {nothing}, **how)
    finally:
        bpy.data.texts.remove(nothing)
