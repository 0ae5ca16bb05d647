# SPDX-License-Identifier: GPL-3.0-or-later
"""A campfire burns under a tripod; the wind carries its sparks away."""

import math

from ..props import ball, box, cylinder, joined, tube
from ..scene_setup import begin, camera, lamp, light, vapour
from ..simulation_parts import domain, field, flow, particles

BARK = (0.75, 0.7, 0.62)
IRON = (0.05, 0.05, 0.055)


def build():
    """Builds the scene."""
    begin(60)
    box("Clearing", (14, 14, 0.1), (0, 0, -0.05), colour=(0.05, 0.06, 0.03))
    trees = [(-4.5, 4), (-2.6, 5), (-0.6, 4.4), (1.5, 5.2), (3.4, 4.2), (5.2, 5)]
    joined(
        "Pines", *(cylinder("Pine", 0.9, 5, (x, y, 2.5), top=0, colour=(0.02, 0.05, 0.03)) for x, y in trees)
    )
    logs = joined("Birch logs", *(log(number / 5 * 2 * math.pi) for number in range(5)))
    feet = [(0.9 * math.cos(angle), 0.9 * math.sin(angle), 0.03) for angle in (0.5, 2.6, 4.7)]
    legs = [tube("Leg", [(x, y, z), (-0.06 * x, -0.06 * y, 1.75)], 0.025, colour=IRON) for x, y, z in feet]
    joined("Iron tripod", *legs)
    fire = flow(logs, "FIRE")
    fire.fuel_amount = 1.0
    flames = box("Flames", (1.5, 1.2, 1.9), (0.15, 0, 0.93))
    air = domain(vapour(flames, density=2.0, fire=5.0), "GAS", resolution=40)
    air.burning_rate, air.flame_smoke = 0.9, 0.1
    air.beta, air.vorticity, air.effector_weights.wind = 2.2, 0.2, 0.2
    air.timesteps_max = 2
    spark = ball("Spark", 1.0, (0, 0, -0.5), detail=1, colour=(1, 0.45, 0.1), glow=30.0)
    sparks = particles(logs, "Sparks", 250, lifetime=40, size=0.008, shown=spark, speed=1.2)
    sparks.factor_random, sparks.lifetime_random = 0.8, 0.5
    sparks.effector_weights.gravity = -0.12  # the hot air lifts them
    field("Gusty wind", "WIND", 3.0, (-3, 0, 1), turn=(0, math.pi / 2, 0), noise=3.0)
    lamp("Firelight", 60, (0, 0, 0.5), colour=(1, 0.45, 0.15), size=0.2)
    camera((0.6, -4.4, 1.5), (0.5, 0, 0.95))
    light(sun=0.15, sky=(0.008, 0.012, 0.03), colour=(0.6, 0.7, 1))


def log(turn):
    """A split log that leans to the middle of the fire."""
    low, high = 0.42, 0.06
    foot = (low * math.cos(turn), low * math.sin(turn), 0.07)
    return tube("Log", [foot, (high * math.cos(turn), high * math.sin(turn), 0.42)], 0.055, colour=BARK)
