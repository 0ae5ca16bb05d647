# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of what flows, what it flows in, and what stands in its way."""

import bpy

from .lookup import fluids_of, modifiers_of, named

_OTHER = {"LIQUID": "SMOKE", "SMOKE": "LIQUID", "BOTH": "LIQUID", "FIRE": "LIQUID"}
_OTHER_DOMAIN = {"LIQUID": "GAS", "GAS": "LIQUID"}
_OTHER_EFFECTOR = {"COLLISION": "GUIDE", "GUIDE": "COLLISION"}
_FAR = 1e5  # in the scene's units
_LEAST_RESOLUTION = 6


def swap(things, kind):
    """Makes fluids of that kind (DOMAIN, FLOW, EFFECTOR) another sort of it, as smoke for liquid."""
    found = fluids_of(kind, things)
    for _, settings in found:
        if kind == "FLOW":
            settings.flow_type = _OTHER[settings.flow_type]
        elif kind == "DOMAIN":
            settings.domain_type = _OTHER_DOMAIN[settings.domain_type]
        else:
            settings.effector_type = _OTHER_EFFECTOR[settings.effector_type]
    return [thing for thing, _ in found]


def close_flows(things, flows, least):
    """Closes so many of ``flows`` (names) that fewer than ``least`` are open: inflows by their switch, others muted."""
    del things
    shut = named(flows)[: len(flows) - least + 1]
    for _, modifier in modifiers_of(shut, {"FLUID"}, "FLOW"):
        if modifier.flow_settings.flow_behavior == "INFLOW":
            modifier.flow_settings.use_inflow = False
        else:
            modifier.show_render = False
    return shut


def remove_domains(things):
    """Takes their fluid modifiers off all domains of the scene."""
    del things
    found = modifiers_of(bpy.context.scene.objects, {"FLUID"}, "DOMAIN")
    for thing, modifier in found:
        thing.modifiers.remove(modifier)
    return [thing for thing, _ in found]


def put_away(things):
    """Puts flows and effectors where no domain reaches, whatever their keys say."""
    found = modifiers_of(things, {"FLUID"}, "FLOW") + modifiers_of(things, {"FLUID"}, "EFFECTOR")
    for thing, _ in found:
        thing.delta_location.x += _FAR
    return [thing for thing, _ in found]


def ignore(things):
    """Has effectors take no part: these, or all."""
    found = fluids_of("EFFECTOR", things or None)
    for _, settings in found:
        settings.use_effector = False
    return [thing for thing, _ in found]


def stand_still(things):
    """Takes their keys off effectors, and off what these follow."""
    found = [thing for thing, _ in fluids_of("EFFECTOR", things)]
    moving = [each for thing in found for each in _led_by(thing) if each.animation_data is not None]
    for thing in moving:
        thing.animation_data_clear()
    return found if moving else []


def unguide(things):
    """Has no domain be guided."""
    del things
    found = fluids_of("DOMAIN")
    for _, settings in found:
        settings.use_guide = False
    return [thing for thing, _ in found]


def coarsen(things, least):
    """Gives domains fewer divisions than the least."""
    found = fluids_of("DOMAIN", things)
    for _, settings in found:
        settings.resolution_max = max(_LEAST_RESOLUTION, least - 1)
    return [thing for thing, _ in found]


def _led_by(thing):
    while thing is not None:
        yield thing
        thing = thing.parent
