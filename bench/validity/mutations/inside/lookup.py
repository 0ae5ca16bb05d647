# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what to change: objects by their names in the audit, modifiers by type and kind."""

import bpy

from bench.audit.inside.channels import curves_of
from bench.audit.inside.json_values import called


def named(names):
    """The objects of those names, in that order."""
    known = {called(obj): obj for obj in bpy.data.objects}
    return [known[name] for name in names if name in known]


def modifiers_of(objects, types, kind=None):
    """(object, modifier) for each modifier of these types; ``kind``: of a fluid, or of a particle system."""
    return [
        (obj, modifier)
        for obj in objects
        for modifier in obj.modifiers
        if modifier.type in types and kind in (None, kind_of(modifier))
    ]


def kind_of(modifier):
    """DOMAIN, FLOW, EFFECTOR of a fluid; EMITTER, HAIR of particles; None of others."""
    if modifier.type == "FLUID":
        return modifier.fluid_type
    if modifier.type == "PARTICLE_SYSTEM":
        return modifier.particle_system.settings.type
    return None


def fluids_of(kind, objects=None):
    """(object, settings) for each fluid modifier of that kind; without ``objects``, in the scene."""
    pairs = modifiers_of(bpy.context.scene.objects if objects is None else objects, {"FLUID"}, kind)
    return [(obj, getattr(modifier, f"{kind.lower()}_settings")) for obj, modifier in pairs]


def mute_keys(obj, path):
    """Mutes the keys of a property of an object."""
    animated = obj.animation_data
    if animated is not None and animated.action is not None:
        for curve in curves_of(animated.action, animated.action_slot):
            curve.mute = curve.mute or curve.data_path == path


def split(owner, path):
    """Splits a dotted path: (the block below ``owner`` that has the last attribute, its name)."""
    *steps, last = path.split(".")
    for step in steps:
        owner = getattr(owner, step)
    return owner, last
