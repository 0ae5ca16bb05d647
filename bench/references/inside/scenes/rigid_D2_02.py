# SPDX-License-Identifier: GPL-3.0-or-later
"""A barrel rolls through two swinging doors, which sway behind it."""

import math

from ..props import box, boxes, joined, revolved
from ..scene_setup import begin, camera, light
from ..simulation_parts import body, joint, limits, thrown

WIDE, TALL, LOW = 1.2, 1.0, 0.42  # of the doorway: its width; how tall the leaves are, and how high they hang
POST = 0.12
GAP = 0.008  # around a leaf
RADIUS, LONG = 0.27, 0.7  # of the barrel
SPEED = 2.8


def build():
    """Builds the scene."""
    begin(76)
    floor = box("Floorboards", (9, 4, 0.1), (0, 0, -0.05), colour=(0.36, 0.24, 0.13))
    body(floor, "PASSIVE", shape="BOX", friction=0.8)
    posts = [((POST, POST, 2.1), (0, j * (WIDE + POST) / 2, 1.05)) for j in (-1, 1)]
    lintel = ((POST, WIDE + 2 * POST, POST), (0, 0, 2.1 + POST / 2))
    frame = boxes("Door frame", [*posts, lintel], colour=(0.3, 0.17, 0.08))
    body(frame, "PASSIVE", shape="MESH")
    for side in (-1, 1):
        _leaf(side, frame)
    barrel = _barrel()
    barrel.location, barrel.rotation_euler = (-2.3, 0, RADIUS), (math.pi / 2, 0, 0)
    body(barrel, mass=60, friction=0.7)
    thrown(barrel, (SPEED, 0, 0), (0, SPEED / RADIUS, 0))
    camera((3.0, -4.9, 2.2), (0.4, 0, 0.8), lens=30)
    light(elevation=20, azimuth=60, colour=(1, 0.75, 0.5), sky=(0.5, 0.4, 0.4))


def _leaf(side, frame):
    """Hangs on the post of its side, and is drawn back by a spring in its hinges."""
    wide = WIDE / 2 - 1.5 * GAP
    at = (0, side * (GAP / 2 + wide / 2), LOW + TALL / 2)
    leaf = box("Door leaf", (0.035, wide, TALL), at, colour=(0.2, 0.45, 0.4))
    body(leaf, shape="BOX", mass=5, friction=0.1)
    hinge = joint("Brass hinge", "GENERIC_SPRING", frame, leaf, (0, side * WIDE / 2, LOW + TALL / 2))
    limits(hinge, **dict.fromkeys(("lin_x", "lin_y", "lin_z", "ang_x", "ang_y"), (0, 0)))
    limits(hinge, ang_z=(-1.9, 1.9))
    hinge.use_spring_ang_z, hinge.spring_stiffness_ang_z, hinge.spring_damping_ang_z = True, 14, 0.5


def _barrel():
    """Around Z, with two hoops."""
    heights = [LONG * (step / 10 - 0.5) for step in range(11)]
    staves = [(RADIUS - 0.05 * (2 * height / LONG) ** 2, height) for height in heights]
    wood = revolved("Staves", [(0, -LONG / 2), *staves, (0, LONG / 2)], colour=(0.42, 0.26, 0.12))
    hoops = [_hoop(height) for height in (-0.18, 0.18)]
    return joined("Whisky barrel", wood, *hoops)


def _hoop(height):
    out, to = RADIUS - 0.008, RADIUS - 0.04
    ring = [
        (out, height - 0.02),
        (out, height + 0.02),
        (to, height + 0.02),
        (to, height - 0.02),
        (out, height - 0.02),
    ]
    return revolved("Hoop", ring, colour=(0.15, 0.15, 0.16), metal=1.0)
