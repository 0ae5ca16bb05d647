# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what is to be changed: objects by the names that the audit has for them, modifiers by type and kind."""

import bpy

from bench.audit.inside.channels import curves_of
from bench.audit.inside.json_values import called


def named(names):
    """The objects of those names, in that order."""
    known = {called(thing): thing for thing in bpy.data.objects}
    return [known[name] for name in names if name in known]


def modifiers_of(things, types, kind=None):
    """(object, modifier) for each modifier of these types; ``kind``: of a fluid, or of a particle system."""
    return [
        (thing, modifier)
        for thing in things
        for modifier in thing.modifiers
        if modifier.type in types and kind in (None, kind_of(modifier))
    ]


def kind_of(modifier):
    """DOMAIN, FLOW, EFFECTOR of a fluid; EMITTER, HAIR of particles; None of others."""
    if modifier.type == "FLUID":
        return modifier.fluid_type
    if modifier.type == "PARTICLE_SYSTEM":
        return modifier.particle_system.settings.type
    return None


def fluids_of(kind, things=None):
    """(object, settings) for each fluid modifier of that kind; without ``things``, in the scene."""
    found = modifiers_of(bpy.context.scene.objects if things is None else things, {"FLUID"}, kind)
    return [(thing, getattr(modifier, f"{kind.lower()}_settings")) for thing, modifier in found]


def mute_keys(thing, path):
    """Keeps keys from setting a property of an object."""
    animated = thing.animation_data
    if animated is not None and animated.action is not None:
        for curve in curves_of(animated.action, animated.action_slot):
            curve.mute = curve.mute or curve.data_path == path


def split(owner, path):
    """What ``path`` leads to on ``owner``: (the block that has it, the attribute)."""
    *steps, last = path.split(".")
    for step in steps:
        owner = getattr(owner, step)
    return owner, last
