# SPDX-License-Identifier: GPL-3.0-or-later
"""Three gummy bears drop onto a glass dish, squash and bob upright.

They are larger than life: what falls as far as it is tall, when that is a centimetre, is down within a frame.
"""

from ..props import ball, boxes, fused, legs, revolved
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, soft
from ..soft_body_struts import braced

TOP = 0.72
DISH = [(0, 0), (0.4, 0), (0.62, 0.05), (0.62, 0.075), (0.4, 0.04), (0, 0.04)]
# Of a bear that is 0.35 m tall: (radius, place).
FEET = [(0.05, (side * 0.07, -0.09, 0.05)) for side in (-1, 1)]
HANDS = [(0.036, (side * 0.09, -0.05, 0.18)) for side in (-1, 1)]
BEAR = [
    (0.1, (0, 0, 0.1)),
    (0.06, (0, 0.08, 0.06)),
    (0.08, (0, 0, 0.19)),
    (0.075, (0, 0, 0.28)),
    (0.03, (0, -0.065, 0.27)),
]
EARS = [(0.026, (side * 0.055, 0, 0.35)) for side in (-1, 1)]


def build():
    """Builds the scene."""
    begin(72)
    boxes(
        "Garden table",
        [*legs(1, 0.7, TOP - 0.06), ((2.2, 1.6, 0.06), (0, 0, TOP - 0.03))],
        colour=(0.9, 0.9, 0.88),
    )
    dish = revolved("Cut-glass dish", DISH, (0, 0, TOP), colour=(0.75, 0.85, 0.9), roughness=0.05, clear=0.8)
    collider(dish, thickness=0.01, inner=0.018, damping=0.6)
    for name, x, drop, colour in (
        ("Red bear", -0.27, 0.2, (0.75, 0.03, 0.03)),
        ("Yellow bear", 0, 0.28, (0.85, 0.65, 0.02)),
        ("Green bear", 0.27, 0.36, (0.05, 0.5, 0.08)),
    ):
        parts = [
            ball("Part", radius, (x + right, front, TOP + 0.05 + drop + up), detail=2)
            for radius, (right, front, up) in [*BEAR, *FEET, *HANDS, *EARS]
        ]
        bear = fused(name, 0.032, *parts, colour=colour, roughness=0.2)
        soft(braced(bear), stiffness=0.35, bending=0, damping=0).settings.friction = 0.2
    camera((0.9, -2.1, 1.5), (0, 0, 0.95), lens=42)
    light(elevation=18, azimuth=40, sky=(0.7, 0.55, 0.45), colour=(1, 0.8, 0.6))
