# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of fluid flows, domains and effectors."""

import bpy

from .lookup import fluids_of, modifiers_of, named

_OTHER = {"LIQUID": "SMOKE", "SMOKE": "LIQUID", "BOTH": "LIQUID", "FIRE": "LIQUID"}
_OTHER_DOMAIN = {"LIQUID": "GAS", "GAS": "LIQUID"}
_OTHER_EFFECTOR = {"COLLISION": "GUIDE", "GUIDE": "COLLISION"}
_FAR = 1e5  # in the scene's units
_LEAST_RESOLUTION = 6


def swap_fluid_type(objects, kind):
    """Gives fluid modifiers of that kind (DOMAIN, FLOW, EFFECTOR) another type, such as smoke for liquid."""
    fluids = fluids_of(kind, objects)
    for _, settings in fluids:
        if kind == "FLOW":
            settings.flow_type = _OTHER[settings.flow_type]
        elif kind == "DOMAIN":
            settings.domain_type = _OTHER_DOMAIN[settings.domain_type]
        else:
            settings.effector_type = _OTHER_EFFECTOR[settings.effector_type]
    return [obj for obj, _ in fluids]


def close_flows(objects, flows, least):
    """Closes so many of ``flows`` (names) that fewer than ``least`` are open: inflows by their switch, others muted."""
    del objects
    shut = named(flows)[: len(flows) - least + 1]
    for _, modifier in modifiers_of(shut, {"FLUID"}, "FLOW"):
        if modifier.flow_settings.flow_behavior == "INFLOW":
            modifier.flow_settings.use_inflow = False
        else:
            modifier.show_render = False
    return shut


def remove_domains(objects):
    """Removes all fluid domains of the scene."""
    del objects
    domains = modifiers_of(bpy.context.scene.objects, {"FLUID"}, "DOMAIN")
    for obj, modifier in domains:
        obj.modifiers.remove(modifier)
    return [obj for obj, _ in domains]


def move_out_of_domain(objects):
    """Moves flows and effectors far out of any domain, whatever their keys say."""
    moved = modifiers_of(objects, {"FLUID"}, "FLOW") + modifiers_of(objects, {"FLUID"}, "EFFECTOR")
    for obj, _ in moved:
        obj.delta_location.x += _FAR
    return [obj for obj, _ in moved]


def disable_effector(objects):
    """Disables effectors: these, or all."""
    effectors = fluids_of("EFFECTOR", objects or None)
    for _, settings in effectors:
        settings.use_effector = False
    return [obj for obj, _ in effectors]


def remove_keys(objects):
    """Removes the keys of effectors and of their parents."""
    effectors = [obj for obj, _ in fluids_of("EFFECTOR", objects)]
    moving = [each for obj in effectors for each in _led_by(obj) if each.animation_data is not None]
    for obj in moving:
        obj.animation_data_clear()
    return effectors if moving else []


def disable_guiding(objects):
    """Turns guiding off in all domains."""
    del objects
    domains = fluids_of("DOMAIN")
    for _, settings in domains:
        settings.use_guide = False
    return [obj for obj, _ in domains]


def lower_resolution(objects, least):
    """Lowers the resolution of domains below ``least``."""
    domains = fluids_of("DOMAIN", objects)
    for _, settings in domains:
        settings.resolution_max = max(_LEAST_RESOLUTION, least - 1)
    return [obj for obj, _ in domains]


def _led_by(obj):
    while obj is not None:
        yield obj
        obj = obj.parent
