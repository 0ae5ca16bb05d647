# SPDX-License-Identifier: GPL-3.0-or-later
"""Gases as volumes that play the files of their bake."""

import bpy
from mathutils import Matrix, Vector

from .placing import put


def settings_of(thing):
    """The settings of an object's domain, if that is of a gas."""
    for modifier in thing.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
            settings = modifier.domain_settings
            return settings if settings.domain_type == "GAS" else None
    return None


def volume_of(thing):
    """(a volume that plays the files of a gas's bake, with its material; how long the side of a cell is)."""
    settings = settings_of(thing)
    volume = bpy.data.volumes.new(thing.name)
    part = "noise" if settings.use_noise else "data"
    volume.filepath = f"{settings.cache_directory}/{part}/fluid_{part}_0001.vdb"
    volume.is_sequence = True
    volume.frame_start, volume.frame_duration = 1, settings.cache_frame_end
    for slot in thing.material_slots:
        volume.materials.append(slot.material)
    corners = [Vector(corner) for corner in thing.bound_box]
    divisions = settings.resolution_max * (settings.noise_scale if settings.use_noise else 1)
    return volume, max(corners[6] - corners[0]) / divisions


def put_in_place(thing, volume, cell):
    """Puts a volume in the place of a gas's domain."""
    # Where a domain has the corner of its first cell, the file has the middle of it.
    first = Vector(thing.bound_box[0]) + Vector((cell, cell, cell)) / 2
    name, matrix = thing.name, thing.matrix_world @ Matrix.Translation(first)
    bpy.data.objects.remove(thing)
    put(name, volume, matrix)
