# SPDX-License-Identifier: GPL-3.0-or-later
"""A film as files that modifiers play: point caches for meshes that keep their points, Alembic for others."""

import os
import struct

import bpy
import numpy

_HEADER = struct.Struct("<12siiffi")


def play(thing, frames, shapes, path):
    """Has a mesh object go through shapes (n × 3, own space) that lie in the file ``path``."""
    with open(path, "wb") as file:
        file.write(_HEADER.pack(b"POINTCACHE2\0", 1, len(shapes[0]), 0.0, 1.0, len(shapes)))
        for points in shapes:
            file.write(numpy.ascontiguousarray(points, dtype="<f4").tobytes())
    modifier = thing.modifiers.new("Mesh cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", beside(path)
    modifier.time_mode, modifier.frame_start = "FRAME", frames[0]
    modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"


def export(thing, frames, path):
    """Writes what an object looks like at each frame to an Alembic file."""
    bpy.ops.object.select_all(action="DESELECT")
    thing.select_set(True)
    bpy.ops.wm.alembic_export(
        filepath=path,
        start=frames[0],
        end=frames[-1],
        selected=True,
        normals=False,
        export_particles=False,  # those that a liquid is made of
        export_hair=False,
        as_background_job=False,
    )


def imported(path):
    """The mesh object that an Alembic file holds, which plays it."""
    before = set(bpy.data.objects)
    bpy.ops.wm.alembic_import(filepath=path, set_frame_range=False, as_background_job=False)
    found = [thing for thing in bpy.data.objects if thing not in before and thing.type == "MESH"]
    thing = found[0]
    thing.modifiers[0].cache_file.filepath = beside(path)
    flat = thing.modifiers.new("Flat faces", "EDGE_SPLIT")  # as a fluid's are; Alembic would have them smooth
    flat.split_angle = 0.0
    return thing


def beside(path):
    """A path as it is written into a file that lies in the same folder."""
    return f"//{os.path.basename(path)}"
