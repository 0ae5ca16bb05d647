# SPDX-License-Identifier: GPL-3.0-or-later
"""Dough slides off a tilted peel and slumps onto a counter dusted with flour."""

from ..props import box, boxes, prism, revolved
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, soft
from ..soft_body_struts import braced

TOP = 0.9
TILT, THICK = 32, 0.03  # of the peel: degrees, metres
LUMP = [
    (0, 0),
    (0.08, 0),
    (0.125, 0.008),
    (0.14, 0.035),
    (0.13, 0.07),
    (0.095, 0.1),
    (0.045, 0.115),
    (0, 0.118),
]


def build():
    """Builds the scene."""
    begin(84)
    counter = box("Steel counter", (1.9, 0.9, TOP), (0, 0, TOP / 2), colour=(0.6, 0.62, 0.65), metal=1.0)
    collider(counter, thickness=0.004, inner=0.05, damping=0.5)
    box("Flour", (0.5, 0.5, 0.002), (-0.4, 0, TOP + 0.001), colour=(0.92, 0.9, 0.86))
    wood = (0.7, 0.5, 0.3)
    parts = [((0.5, 0.36, THICK), (0, 0, 0)), ((0.6, 0.06, THICK), (0.55, 0, 0))]  # the blade, the handle
    peel = boxes("Beechwood peel", parts, (0.1, 0, TOP + 0.3), turn=(0, -TILT, 0), colour=wood)
    collider(peel, thickness=0.006, inner=0.014, damping=0.06)
    along, up = peel.matrix_world.to_3x3().col[0], peel.matrix_world.to_3x3().col[2]
    low, high = (peel.location + way * along - THICK / 2 * up for way in (0.1, 0.5))
    rest = [(low.x, TOP), (high.x, TOP), (high.x, high.z), (low.x, low.z)]
    prism("Stand", rest, 0.2, colour=(0.4, 0.27, 0.16))
    lump = revolved("Bread dough", LUMP, sides=24, colour=(0.88, 0.78, 0.6), roughness=0.8)
    lump.rotation_euler, lump.location = peel.rotation_euler, peel.location + 0.06 * along + 0.022 * up
    soft(braced(lump), stiffness=0.03, bending=0, damping=1, stretch=0.02)
    camera((0.5, -1.7, 1.6), (0, 0, 1.05), lens=35)
    light(elevation=30, azimuth=-50, sky=(0.4, 0.38, 0.4))
