# SPDX-License-Identifier: GPL-3.0-or-later
"""New objects in the open scene."""

import bpy


def put(name, data, matrix):
    """An object with that data, where ``matrix`` has it."""
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.matrix_world = matrix
    return thing
