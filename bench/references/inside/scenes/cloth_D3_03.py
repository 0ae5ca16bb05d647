# SPDX-License-Identifier: GPL-3.0-or-later
"""A carpet drops from a balcony onto cobblestones; as it crumples, dust bursts from it and rolls over the ground."""

from ..props import ball, box, boxes, sheet
from ..scene_setup import begin, camera, light
from ..simulation_parts import cloth, collider, particles

SAND, DUST = (0.72, 0.56, 0.36), (0.5, 0.48, 0.45)


def build():
    """Builds the scene."""
    begin(72)
    collider(box("Cobblestones", (8, 7, 0.2), (0, 0, -0.1), colour=(0.4, 0.36, 0.32)), friction=50)
    box("House front", (5, 0.3, 4.2), (0, 1.9, 2.1), colour=SAND)
    slab, front = ((2.4, 1.0, 0.18), (0, 1.25, 2.3)), ((2.4, 0.1, 0.7), (0, 0.8, 2.74))
    ends = [((0.1, 0.9, 0.7), (x, 1.3, 2.74)) for x in (-1.15, 1.15)]
    boxes("Sandstone balcony", [slab, front, *ends], colour=SAND)
    # Just pushed over the edge, and let go.
    wool = sheet(
        "Wool carpet", (1.5, 2.0), (36, 48), (0, 0.3, 2.35), turn=(65, 0, 5), colour=(0.55, 0.1, 0.1)
    )
    cloth(wool, mass=0.4, stiffness=25, self_collision=True, distance=0.015).settings.bending_stiffness = 5
    grain = ball("Dust grain", 1, (0, 0, -3), detail=1, colour=DUST)
    dust = particles(wool, "Dust", 2500, first=20, until=38, lifetime=50, size=0.022, shown=grain, speed=0.8)
    dust.lifetime_random, dust.size_random, dust.factor_random = 0.5, 0.7, 1.2
    dust.drag_factor, dust.damping, dust.brownian_factor = 0.3, 0.02, 0.5
    dust.effector_weights.gravity = 0.05  # dust hangs in the air
    camera((3.8, -4.8, 2.4), (0, 0.4, 1.6), lens=28)
    light(sun=2.5, elevation=50, azimuth=-50, sky=(0.5, 0.47, 0.4), colour=(1, 0.9, 0.75))
