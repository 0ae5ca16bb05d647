# SPDX-License-Identifier: GPL-3.0-or-later
"""A pumpkin, given a push, bounces down a stairway and rolls out on the path."""

import math

from ..props import box, boxes, cylinder, joined, revolved
from ..scene_setup import begin, camera, light
from ..simulation_parts import body, thrown

STEPS, DEEP, HIGH, WIDE = 6, 0.42, 0.17, 1.6
RADIUS, SQUAT, RIBS = 0.22, 0.85, 14
SPEED = 1.6  # of the push, m/s


def build():
    """Builds the scene."""
    begin(84)
    path = box("Gravel path", (9, 3, 0.1), (2.5, 0, -0.05), colour=(0.5, 0.47, 0.42), roughness=1.0)
    body(path, "PASSIVE", shape="BOX", friction=0.8)
    blocks = [_step(number) for number in range(STEPS)]
    stairway = boxes("Stone stairway", blocks, colour=(0.33, 0.38, 0.27), roughness=0.95)
    body(stairway, "PASSIVE", shape="MESH", friction=0.7, bounce=0.4)
    pumpkin = _pumpkin((-0.2, 0, STEPS * HIGH + RADIUS))
    body(pumpkin, mass=4.0, friction=0.7, bounce=0.4)
    thrown(pumpkin, (SPEED, 0, 0), (0, SPEED / RADIUS, 0))
    camera((3.4, -4.3, 1.9), (1.75, 0, 0.45), lens=32)
    light(elevation=25, azimuth=30, colour=(1, 0.9, 0.75))


def _step(number):
    """Of the highest the back, of each what is under its tread."""
    high = (STEPS - number) * HIGH
    back = 0.6 if number == 0 else 0
    return (DEEP + back, WIDE, high), (number * DEEP + (DEEP - back) / 2, 0, high / 2)


def _pumpkin(at):
    """Lies on its side, as it has to in order to roll: its stalk shows across the stairway."""
    around = [math.pi * step / 12 for step in range(13)]
    profile = [(RADIUS * math.sin(turn), -RADIUS * SQUAT * math.cos(turn)) for turn in around]
    profile[0], profile[-1] = (0, profile[0][1] + 0.02), (0, profile[-1][1] - 0.02)
    flesh = revolved("Pumpkin", profile, at, sides=4 * RIBS, colour=(0.9, 0.35, 0.04))
    for point in flesh.data.vertices:
        angle = math.atan2(point.co.y, point.co.x)
        point.co.xy *= 0.97 + 0.03 * abs(math.sin(RIBS * angle / 2))
    stalk = cylinder(
        "Stalk", 0.03, 0.09, (*at[:2], at[2] + RADIUS * SQUAT), top=0.02, colour=(0.3, 0.35, 0.12)
    )
    pumpkin = joined("Pumpkin", flesh, stalk)
    pumpkin.rotation_euler.x = math.pi / 2
    return pumpkin
