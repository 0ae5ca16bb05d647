# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair particles as curves."""

import bpy
import numpy


def style_of(obj, name):
    """(the material of a system's hair, if it has one; its diameter at the root, and at the tip)."""
    settings = obj.particle_systems[name].settings
    place = settings.material - 1
    material = obj.material_slots[place].material if place < len(obj.material_slots) else None
    return material, settings.radius_scale * settings.root_radius, settings.radius_scale * settings.tip_radius


def curves(name, strands, style):
    """Makes hair curves of strands, each an array of points."""
    material, root, tip = style
    data = bpy.data.hair_curves.new(name)
    data.add_curves([len(strand) for strand in strands])
    data.position_data.foreach_set("vector", numpy.concatenate(strands).astype(numpy.float32).ravel())
    radii = numpy.concatenate([numpy.linspace(root, tip, len(strand)) / 2 for strand in strands])
    data.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", radii.astype(numpy.float32))
    data.materials.append(material)
    return data
