# SPDX-License-Identifier: GPL-3.0-or-later
"""A flare bursts over a beach; each of its fragments draws a trail of smoke."""

from ..props import ball, box
from ..scene_setup import begin, camera, light, vapour
from ..simulation_parts import collider, domain, flow, particles


def build():
    """Builds the scene."""
    begin(60)
    collider(box("Pebble beach", (40, 40, 0.2), (0, 0, -0.1), colour=(0.2, 0.19, 0.18)), damping=0.9)
    flare = ball("Magnesium flare", 0.15, (0, 0, 6), colour=(1, 0.9, 0.75), glow=20.0)
    fragment = ball("Glowing fragment", 1.0, (0, 0, -2), detail=1, colour=(1, 0.85, 0.6), glow=40.0)
    thrown = particles(
        flare, "Burst", 20, first=2, until=4, lifetime=70, size=0.06, shown=fragment, speed=5.0
    )
    thrown.factor_random, thrown.effector_weights.gravity = (
        1.0,
        0.5,
    )  # light as they are, the air carries them
    trail = flow(flare, "SMOKE")
    trail.flow_source, trail.particle_system = "PARTICLES", flare.particle_systems[0]
    trail.density, trail.subframes = 2.0, 2
    smoke = box("White smoke", (12, 12, 8.5), (0, 0, 4.3))
    air = domain(vapour(smoke, colour=(0.95, 0.95, 0.97), density=3.0), "GAS", resolution=64)
    air.alpha = air.beta = 0.1
    camera((2, -16, 2.2), (0, 0, 3.8))
    light(sun=3, elevation=12, azimuth=20, sky=(0.04, 0.05, 0.09), colour=(1, 0.85, 0.75))
