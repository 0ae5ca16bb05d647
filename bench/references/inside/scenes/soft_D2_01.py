# SPDX-License-Identifier: GPL-3.0-or-later
"""A rubber cactus, held at its root in a pot, whips over in a gust and sways upright again."""

from ..props import ball, box, cylinder, fused, revolved, tube, weigh
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import field, soft
from ..soft_body_struts import braced

SILL = 0.9
POT = [(0, 0), (0.07, 0), (0.095, 0.15), (0.105, 0.15), (0.105, 0.18), (0.085, 0.18), (0.08, 0.14), (0, 0.14)]
EARTH = SILL + 0.14


def build():
    """Builds the scene."""
    begin(96)
    box("Windowsill", (1.4, 0.36, 0.06), (0, 0, SILL - 0.03), colour=(0.85, 0.83, 0.78))
    box("Wall", (1.4, 0.26, SILL - 0.06), (0, 0.05, SILL / 2 - 0.03), colour=(0.7, 0.66, 0.6))
    revolved("Terracotta pot", POT, (0, 0, SILL), colour=(0.6, 0.27, 0.14), roughness=0.9)
    trunk = cylinder("Trunk", 0.055, 0.5, (0, 0, EARTH + 0.25))
    crown = ball("Crown", 0.055, (0, 0, EARTH + 0.5))
    arms = [
        tube(
            "Arm",
            [(0, 0, low), (side * 0.1, 0, low), (side * 0.13, 0, low + 0.04), (side * 0.13, 0, high)],
            0.032,
            (0, 0, EARTH),
        )
        for side, low, high in ((-1, 0.2, 0.38), (1, 0.28, 0.44))
    ]
    cactus = braced(
        fused("Rubber cactus", 0.027, trunk, crown, *arms, colour=(0.1, 0.42, 0.16), roughness=0.4)
    )
    root = weigh(cactus, "Root", lambda point: point.z < -0.22)
    soft(cactus, goal=root, stiffness=0.97, bending=0, damping=0)
    gust = field("Gust of wind", "WIND", 0, (-1, 0, EARTH + 0.3), turn=(0, 1.57, 0))
    keys(gust, "field.strength", {1: 0.0, 10: 0.0, 16: 30.0, 26: 30.0, 32: 0.0})
    camera((0.5, -1.7, 1.35), (0.05, 0, 1.22), lens=36)
    light(elevation=35, azimuth=-30)
