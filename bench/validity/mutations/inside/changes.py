# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks one thing about the open scene. The changes are listed here, by name; each is a function of its own."""

from bench.audit.inside.json_values import called
from simworlds.sandbox.inside.refusal import Refused

from . import bodies, caches, fakes, fluids, modifiers
from .lookup import named

# Each gets objects and what else it needs by name, and returns the objects that it changed; none: there was nothing to
# change.
CHANGES = {
    each.__name__: each
    for each in (
        *(modifiers.hide, modifiers.mute, modifiers.remove, modifiers.put_first, modifiers.set_value),
        *(modifiers.clear_group, modifiers.spare),
        *(caches.free, caches.free_world, caches.shorten, caches.shorten_world, caches.lose_files),
        *(caches.forget_bake,),
        *(
            bodies.set_body,
            bodies.turn_type,
            bodies.grab,
            bodies.other_shape,
            bodies.remove_body,
            bodies.expel,
        ),
        *(bodies.switch_off_world, bodies.untie, bodies.let_collide),
        *(fluids.swap, fluids.close_flows, fluids.remove_domains, fluids.put_away, fluids.ignore),
        *(fluids.stand_still, fluids.unguide, fluids.coarsen),
        *(fakes.calm, fakes.record, fakes.reshape, fakes.play_mesh, fakes.add_bake, fakes.add_body),
        *(fakes.add_solver,),
    )
}


def sabotage(change, objects, options):
    """Changes the open scene. Returns the names of the objects that were changed, sorted.

    Raises Refused where there is nothing that the change could break.
    """
    changed = CHANGES[change](named(objects), **options)
    if not changed:
        raise Refused(f"{change}: there is nothing to change")
    return sorted({called(thing) for thing in changed})
