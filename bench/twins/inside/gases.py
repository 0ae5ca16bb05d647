# SPDX-License-Identifier: GPL-3.0-or-later
"""Gases as volumes that play the files of their bake."""

import bpy
from mathutils import Matrix, Vector
from placing import put


def settings_of(thing):
    """The settings of an object's domain, if that is of a gas."""
    for modifier in thing.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
            settings = modifier.domain_settings
            return settings if settings.domain_type == "GAS" else None
    return None


def volume_of(thing):
    """A volume that plays the files of a gas's bake, with its material."""
    settings = settings_of(thing)
    volume = bpy.data.volumes.new(thing.name)
    part = "noise" if settings.use_noise else "data"
    volume.filepath = f"{settings.cache_directory}/{part}/fluid_{part}_0001.vdb"
    volume.is_sequence = True
    volume.frame_start, volume.frame_duration = 1, settings.cache_frame_end
    for slot in thing.material_slots:
        volume.materials.append(slot.material)
    return volume


def put_in_place(thing, volume):
    """Puts a volume in the place of a gas's domain."""
    name, matrix = thing.name, thing.matrix_world @ Matrix.Translation(Vector(thing.bound_box[0]))
    bpy.data.objects.remove(thing)
    put(name, volume, matrix)
