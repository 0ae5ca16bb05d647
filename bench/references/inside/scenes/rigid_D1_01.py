# SPDX-License-Identifier: GPL-3.0-or-later
"""Six bricks, one above the other, fall on a slab and lie in a heap."""

from ..props import box
from ..scene_setup import begin, camera, light
from ..simulation_parts import body

SIZE = (0.24, 0.115, 0.07)
# Where each hangs across the pile (x, y), and how it is turned: none falls flat on the one before.
HUNG = [
    (0.00, 0.00, 12, 5, 10), (0.05, -0.02, -15, 8, 80), (-0.04, 0.03, 10, -20, -35),
    (0.02, 0.03, 25, 5, 140), (-0.03, -0.03, -5, 18, 50), (0.03, 0.00, 15, -12, 110),
]  # fmt: skip


def build():
    """Builds the scene."""
    begin(60)
    slab = box("Concrete slab", (2.4, 2.4, 0.15), (0, 0, -0.075), colour=(0.55, 0.55, 0.53), roughness=0.9)
    body(slab, "PASSIVE", shape="BOX", friction=0.8)
    for number, (x, y, *turn) in enumerate(HUNG):
        shade = 0.9 + 0.04 * number
        brick = box(
            "Brick", SIZE, (x, y, 0.4 + 0.19 * number), turn=turn, colour=(0.5 * shade, 0.17 * shade, 0.1)
        )
        body(brick, shape="BOX", mass=3.2, friction=0.7, bounce=0.15)
    camera((1.1, -1.8, 1.1), (0, 0, 0.58), lens=32)
    light(elevation=70)
