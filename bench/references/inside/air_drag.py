# SPDX-License-Identifier: GPL-3.0-or-later
"""Air drag on light particles."""

GRAVITY = 9.81


def sinks(settings, speed, *, flutter=0.0):
    """Lets the air slow particles down until they fall at ``speed``: snow a metre a second, paper two.

    ``flutter``: how far they are pushed about, as a share of their weight.
    """
    settings.drag_factor = 1.0
    # Drag is its factor × size² × speed², and balances the weight at that speed.
    settings.mass = settings.particle_size**2 * speed**2 / GRAVITY
    settings.brownian_factor = 2 * flutter * settings.mass * GRAVITY  # its force is at most half of it
    return settings
