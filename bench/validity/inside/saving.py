# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the open file."""

import bpy


def save(path):
    """Saves a copy as ``path``; paths to caches stay as they are written."""
    bpy.ops.wm.save_as_mainfile(
        filepath=path, check_existing=False, copy=True, compress=False, relative_remap=False
    )
