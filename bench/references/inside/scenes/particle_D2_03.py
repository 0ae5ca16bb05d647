# SPDX-License-Identifier: GPL-3.0-or-later
"""Two fountains of sparks, set in pots, throw them across each other; they rain down on the paving and hop on."""

from ..props import ball, boxes, joined, revolved, sheet, weigh
from ..scene_setup import begin, camera, lamp, light
from ..simulation_parts import collider, particles

APART = 1.75  # of either pot from the middle
POT = [(0, 0), (0.12, 0), (0.17, 0.26), (0.19, 0.26), (0.19, 0.3), (0.15, 0.3), (0.11, 0.03), (0, 0.03)]


def build():
    """Builds the scene."""
    begin(96)
    slabs = [
        ((0.98, 0.68, 0.1), (x + 0.5 * (y % 2), 0.7 * y, -0.05)) for x in range(-8, 8) for y in range(-8, 9)
    ]
    slabs.append(((17, 12.5, 0.1), (0, 0, -0.055)))  # the joints
    paving = boxes("Granite paving", slabs, colour=(0.13, 0.13, 0.15), roughness=0.15)
    collider(paving, thickness=0.005, damping=0.6)
    paving.collision.damping_random, paving.collision.friction_factor = 0.2, 0.5
    for number, (name, side, colour) in enumerate(
        (("Gold", -1, (1, 0.6, 0.12)), ("Green", 1, (0.15, 1, 0.25)))
    ):
        _fountain(name, side, colour, seed=number)
        lamp(f"Glare {name.lower()}", 60, (side * APART, 0, 0.6), colour=colour)
    camera((0.5, -5.3, 1.3), (0, 0, 0.95), lens=38)
    light(sun=0.15, elevation=50, azimuth=30, sky=(0.01, 0.012, 0.025), colour=(0.6, 0.7, 1))


def _fountain(name, side, colour, *, seed):
    """A pot with its charge, which throws sparks up and to the other side."""
    at = (side * APART, 0, 0)
    pot = revolved("Pot", POT, at, colour=(0.45, 0.2, 0.11), roughness=0.9)
    charge = sheet("Charge", (0.08, 0.08), (2, 2), (*at[:2], 0.26), colour=colour, glow=2.0)
    weigh(charge, "charge", lambda _: True)
    pot = joined(f"{name} fountain", pot, charge)
    spark = ball(f"{name} spark", 1.0, (side, 0, -2), detail=1, colour=colour, glow=3.0)
    sparks = particles(
        pot, f"{name} sparks", 2000, first=-18, until=86, lifetime=36, size=0.013, shown=spark, speed=5.2
    )
    sparks.object_align_factor = (-side * 2.1, 0, 0)
    sparks.factor_random, sparks.lifetime_random, sparks.subframes = 0.5, 0.4, 2
    system = pot.particle_systems[0]
    system.vertex_group_density, system.seed = "charge", seed
