# SPDX-License-Identifier: GPL-3.0-or-later
"""An oar swings through a tub of water, and piles a wave up against the rim ahead of its blade."""

from ..props import box, cylinder, fused, revolved, tube
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import domain, effector, flow

# Walls of two cells, or the water would find its way through.
TUB = [(0, 0), (0.5, 0), (0.56, 0.4), (0.58, 0.4), (0.58, 0.43), (0.51, 0.43), (0.45, 0.05), (0, 0.05)]
GRIP = 1.4  # the height of the hand around which the oar swings
SWING = 0.3  # radians, to either side


def build():
    """Builds the scene."""
    begin(60)
    box("Barnyard ground", (12, 12, 0.2), (0, 0, -0.1), colour=(0.36, 0.27, 0.17), roughness=1.0)
    tub = revolved("Zinc tub", TUB, sides=40, colour=(0.6, 0.63, 0.66), metal=0.6, roughness=0.4)
    effector(tub, thickness=0.5)
    oar = _oar()
    keys(oar, "rotation_euler", {5: (0, SWING, 0), 28: (0, -SWING, 0)})
    wet = effector(oar, thickness=0.5)
    wet.subframes = 1
    flow(cylinder("Rain that fell", 0.47, 0.28, (0, 0, 0.18), top=0.52), behavior="GEOMETRY")
    water = box(
        "Rainwater", (1.24, 1.24, 0.7), (0, 0, 0.37), colour=(0.3, 0.45, 0.5), clear=0.7, roughness=0.05
    )
    settings = domain(water, resolution=44)
    for side in ("left", "right", "front", "back"):  # what slops over the rim runs off
        setattr(settings, f"use_collision_border_{side}", False)
    camera((0.5, -2.0, 1.6), (0, 0, 0.45), lens=34)
    light(sun=3, elevation=35, azimuth=-50, sky=(0.7, 0.65, 0.6), colour=(1, 0.85, 0.7))


def _oar():
    """Its origin is where the hand holds it."""
    shaft = tube("Shaft", [(0, 0, 0.1), (0, 0, -1.0)], 0.025, (0, 0, GRIP))
    blade = box("Blade", (0.04, 0.4, 0.34), (0, 0, GRIP - 1.12))
    return fused("Wooden oar", 0.012, shaft, blade, colour=(0.5, 0.3, 0.13))
