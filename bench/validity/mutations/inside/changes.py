# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutates the open scene: one function for each change, listed here by name."""

from bench.audit.inside.json_values import called
from simworlds.sandbox.inside.refusal import Refused

from . import bodies, caches, cheats, fluids, modifiers
from .lookup import named

# Each takes objects and further options by name, and returns the objects that it changed: none if there was nothing to
# change.
CHANGES = {
    change.__name__: change
    for change in (
        modifiers.hide_in_render,
        modifiers.switch_off,
        modifiers.remove_modifier,
        modifiers.move_first,
        modifiers.set_value,
        modifiers.clear_group,
        modifiers.collide_with_nothing,
        caches.free_bake,
        caches.free_world_bake,
        caches.shorten_cache,
        caches.shorten_world_cache,
        caches.lose_fluid_files,
        caches.clear_fluid_bake,
        bodies.set_body,
        bodies.swap_body_type,
        bodies.keep_kinematic,
        bodies.change_shape,
        bodies.remove_body,
        bodies.remove_from_world,
        bodies.switch_off_world,
        bodies.detach_constraint,
        bodies.enable_constraint_collisions,
        fluids.swap_fluid_type,
        fluids.close_flows,
        fluids.remove_domains,
        fluids.move_out_of_domain,
        fluids.disable_effector,
        fluids.remove_keys,
        fluids.disable_guiding,
        fluids.lower_resolution,
        modifiers.remove_field_strength,
        cheats.key_every_frame,
        cheats.animate_shape_key,
        cheats.add_mesh_cache,
        cheats.add_bake,
        cheats.add_body,
        cheats.add_solver,
    )
}


def mutate(change, objects, options):
    """Changes the open scene. Returns the names of the objects that were changed, sorted.

    Raises Refused where there is nothing to change.
    """
    changed = CHANGES[change](named(objects), **options)
    if not changed:
        raise Refused(f"{change}: there is nothing to change")
    return sorted({called(obj) for obj in changed})
