# SPDX-License-Identifier: GPL-3.0-or-later
"""A cannonball rolls down a ramp and under a banner, which bulges, lets it pass and swings back."""

from ..props import ball, box, boxes, prism, sheet, weigh
from ..scene_setup import begin, camera, light
from ..simulation_parts import body, cloth, collider

OAK = (0.42, 0.26, 0.12)


def build():
    """Builds the scene."""
    begin(84)
    body(box("Flagstones", (12, 6, 0.2), (1.5, 0, -0.1), colour=(0.5, 0.48, 0.44)), "PASSIVE", shape="BOX")
    body(prism("Oak ramp", [(-3, 0), (-1, 0), (-3, 0.9)], 0.8, colour=OAK), "PASSIVE", friction=0.8)
    shot = ball("Cannonball", 0.22, (-2.66, 0, 0.99), colour=(0.08, 0.08, 0.09), roughness=0.5)
    # The damping is what rough stones do to a ball: it stays in sight.
    body(shot, shape="SPHERE", mass=60, friction=0.8).linear_damping = 0.45
    collider(shot, friction=5)
    posts = [((0.1, 0.1, 1.8), (0, y, 0.9)) for y in (-1.1, 1.1)]
    boxes("Timber crossbar", [*posts, ((0.08, 2.4, 0.1), (0, 0, 1.75))], colour=OAK)
    banner = sheet(
        "Canvas banner", (1.7, 1.55), (34, 31), (0, 0, 0.92), turn=(90, 0, 90), colour=(0.65, 0.12, 0.1)
    )
    cloth(banner, pins=weigh(banner, "Pins", lambda point: point.y > 0.77), mass=0.2)
    camera((5, -4.4, 2.2), (0.2, 0.3, 0.6))
    light(elevation=70)
