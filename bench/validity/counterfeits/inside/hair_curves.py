# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair as curves that stand still."""

import bpy
import numpy


def look_of(thing, name):
    """(the material of a system's hair, if it has one; its diameter at the root, and at the tip)."""
    settings = thing.particle_systems[name].settings
    place = settings.material - 1
    material = thing.material_slots[place].material if place < len(thing.material_slots) else None
    return material, settings.radius_scale * settings.root_radius, settings.radius_scale * settings.tip_radius


def curves(name, strands, look):
    """A data-block of strands, each an array of points."""
    material, root, tip = look
    made = bpy.data.hair_curves.new(name)
    made.add_curves([len(strand) for strand in strands])
    made.position_data.foreach_set("vector", numpy.concatenate(strands).astype(numpy.float32).ravel())
    radii = numpy.concatenate([numpy.linspace(root, tip, len(strand)) / 2 for strand in strands])
    made.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", radii.astype(numpy.float32))
    made.materials.append(material)
    return made
