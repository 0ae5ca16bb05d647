# SPDX-License-Identifier: GPL-3.0-or-later
"""New objects in the open scene."""

import bpy


def add_object(name, data, matrix):
    """Adds an object with that data to the scene."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.matrix_world = matrix
    return obj
