# SPDX-License-Identifier: GPL-3.0-or-later
"""A flag, fastened to its pole along one edge, snaps and ripples in the wind."""

from ..props import box, cylinder, joined, revolved, sheet, weigh
from ..scene_setup import begin, camera, light
from ..simulation_parts import cloth, field


def build():
    """Builds the scene."""
    begin(84)
    box("Harbour pier", (7, 4, 0.8), (0.5, 0, -0.4), colour=(0.45, 0.43, 0.42), roughness=0.9)
    pole = cylinder("Pole", 0.04, 3.6, (-1, 0, 1.8), colour=(0.6, 0.62, 0.65), metal=1.0)
    knob = revolved("Knob", [(0, 0), (0.07, 0.04), (0, 0.1)], (-1, 0, 3.6), colour=(0.6, 0.62, 0.65))
    joined("Flagpole", pole, knob)
    flag = sheet(
        "Silk flag", (1.8, 1.2), (45, 30), (-0.055, 0, 2.9), turn=(90, 0, 0), colour=(0.03, 0.06, 0.3)
    )
    pins = weigh(flag, "Fastened", lambda point: point.x < -0.89)
    cloth(flag, pins=pins, mass=0.05, stiffness=20).settings.air_damping = 1
    # A little across the flag, or nothing would set it rippling.
    field("Morning wind", "WIND", 3500, (-3, -0.6, 2.5), turn=(0, 1.57, 0.2), noise=6)
    camera((0.8, -5.4, 2.0), (0.1, 0, 1.75), lens=28)
    light(elevation=25, azimuth=30, sky=(0.65, 0.75, 0.9))
