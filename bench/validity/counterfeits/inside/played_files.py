# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion as files that modifiers play: point caches for meshes with constant topology, Alembic for others."""

import os
import struct

import bpy
import numpy

_HEADER = struct.Struct("<12siiffi")


def play(obj, frames, shapes, path):
    """Lets a mesh play shapes (n × 3, local space) from the file ``path``, which is written."""
    with open(path, "wb") as file:
        file.write(_HEADER.pack(b"POINTCACHE2\0", 1, len(shapes[0]), 0.0, 1.0, len(shapes)))
        for points in shapes:
            file.write(numpy.ascontiguousarray(points, dtype="<f4").tobytes())
    modifier = obj.modifiers.new("Mesh cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", beside(path)
    modifier.time_mode, modifier.frame_start = "FRAME", frames[0]
    modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"


def export(obj, frames, path):
    """Writes the evaluated mesh of an object at each frame to an Alembic file."""
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
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
    """Imports the mesh object of an Alembic file, which it then plays."""
    before = set(bpy.data.objects)
    bpy.ops.wm.alembic_import(filepath=path, set_frame_range=False, as_background_job=False)
    meshes = [obj for obj in bpy.data.objects if obj not in before and obj.type == "MESH"]
    obj = meshes[0]
    obj.modifiers[0].cache_file.filepath = beside(path)
    flat = obj.modifiers.new("Flat faces", "EDGE_SPLIT")  # as a fluid's are; Alembic would have them smooth
    flat.split_angle = 0.0
    return obj


def beside(path):
    """A path relative to a .blend in the same folder."""
    return f"//{os.path.basename(path)}"
