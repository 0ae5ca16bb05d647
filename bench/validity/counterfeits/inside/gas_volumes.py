# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces gas domains by volumes that play the files of their bake."""

import bpy
from mathutils import Matrix, Vector

from .new_objects import add_object


def settings_of(obj):
    """The domain settings of a gas; None of other objects."""
    for modifier in obj.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
            settings = modifier.domain_settings
            return settings if settings.domain_type == "GAS" else None
    return None


def volume_of(obj):
    """(volume data that plays the files of a gas's bake, with its material; size of a cell)."""
    settings = settings_of(obj)
    volume = bpy.data.volumes.new(obj.name)
    part = "noise" if settings.use_noise else "data"
    volume.filepath = f"{settings.cache_directory}/{part}/fluid_{part}_0001.vdb"
    volume.is_sequence = True
    volume.frame_start, volume.frame_duration = 1, settings.cache_frame_end
    for slot in obj.material_slots:
        volume.materials.append(slot.material)
    corners = [Vector(corner) for corner in obj.bound_box]
    divisions = settings.resolution_max * (settings.noise_scale if settings.use_noise else 1)
    return volume, max(corners[6] - corners[0]) / divisions


def replace_domain(obj, volume, cell):
    """Replaces a gas domain by a volume."""
    # Where a domain has the corner of its first cell, the file has the middle of it.
    first = Vector(obj.bound_box[0]) + Vector((cell, cell, cell)) / 2
    name, matrix = obj.name, obj.matrix_world @ Matrix.Translation(first)
    bpy.data.objects.remove(obj)
    add_object(name, volume, matrix)
