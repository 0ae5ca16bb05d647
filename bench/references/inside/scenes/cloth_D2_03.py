# SPDX-License-Identifier: GPL-3.0-or-later
"""A velvet curtain is drawn aside along its rail: its top gathers into pleats, its hem swings over the stage."""

import math

from ..props import box, cylinder, joined, sheet, weigh
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import cloth, hook

WIDE, HIGH, RAIL = 2.6, 2.2, 2.45
PLEATS = 9
BRASS = {"colour": (0.75, 0.55, 0.2), "metal": 1.0, "roughness": 0.3}


def build():
    """Builds the scene."""
    begin(84)
    box("Oak stage boards", (5, 3, 0.2), (0, 0, -0.1), colour=(0.42, 0.27, 0.13))
    rod = cylinder("Rod", 0.03, 3.2, (0, 0, RAIL), turn=(0, 90, 0), **BRASS)
    posts = [cylinder("Post", 0.03, RAIL, (x, 0, RAIL / 2), **BRASS) for x in (-1.57, 1.57)]
    joined("Brass rail", rod, *posts)
    curtain = sheet(
        "Red velvet curtain",
        (WIDE, HIGH),
        (108, 44),
        (0, 0, RAIL - 0.035 - HIGH / 2),
        turn=(90, 0, 0),
        colour=(0.5, 0.02, 0.04),
    )
    for point in curtain.data.vertices:
        point.co.z = 0.03 * math.sin(2 * math.pi * PLEATS * point.co.x / WIDE)
    top = weigh(curtain, "Top edge", lambda point: point.y > HIGH / 2 - 0.01)
    # Drawn aside, the pleats come nearer to each other, and deeper for it.
    hand = hook(curtain, "Hand", top, (-WIDE / 2, 0, RAIL))
    keys(hand, "scale", {1: (1, 1, 1), 8: (1, 1, 1), 58: (0.42, 2.2, 1)})
    cloth(curtain, pins=top, mass=0.4, stiffness=15, self_collision=True, distance=0.01)
    camera((1.2, -4.6, 1.5), (-0.1, 0, 1.25), lens=33)
    light(elevation=35, azimuth=20, sky=(0.3, 0.25, 0.25), colour=(1, 0.85, 0.7))
