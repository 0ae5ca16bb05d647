# SPDX-License-Identifier: GPL-3.0-or-later
"""The first of twelve dominoes is tipped by a hand that nobody sees, and the row falls to its end."""

import math

from mathutils import Matrix, Vector

from ..props import box
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import body

COUNT, APART = 12, 0.055
THICK, WIDE, TALL = 0.016, 0.06, 0.12
TOP = 0.72
# Balance is lost at 7.6 degrees, the arc tangent of a domino's thickness by its height.
TIPPED = math.radians(11)


def build():
    """Builds the scene."""
    begin(72)
    box("Floor", (4, 4, 0.1), (0, 0, -0.05), colour=(0.5, 0.56, 0.5))
    walnut = (0.24, 0.13, 0.07)
    table = box("Table", (1.1, 0.5, 0.04), (0, 0, TOP - 0.02), colour=walnut)
    body(table, "PASSIVE", shape="BOX")
    for x in (-0.5, 0.5):
        box("Leg", (0.05, 0.42, TOP - 0.04), (x, 0, TOP / 2 - 0.02), colour=walnut)
    row = [_domino(number) for number in range(COUNT)]
    _tip(row[0])
    camera((-0.35, -0.9, 1.2), (0, 0, TOP + 0.02), lens=42)
    light(sun=1.5, elevation=35, sky=(0.6, 0.63, 0.7))


def _domino(number):
    x = (number - (COUNT - 1) / 2) * APART
    wood = (0.85, 0.6, 0.35) if number % 2 else (0.6, 0.3, 0.15)
    thing = box("Domino", (THICK, WIDE, TALL), (x, 0, TOP + TALL / 2), colour=wood)
    body(thing, shape="BOX", mass=0.06, friction=0.6)
    return thing


def _tip(thing):
    """Leans it over its lower edge from frame 6 to 14, and lets go."""
    edge = thing.location + Vector((THICK / 2, 0, -TALL / 2))
    leaning = edge + Matrix.Rotation(TIPPED, 3, "Y") @ (thing.location - edge)
    keys(thing, "location", {6: thing.location.copy(), 14: leaning})
    keys(thing, "rotation_euler", {6: (0, 0, 0), 14: (0, TIPPED, 0)})
    keys(thing, "rigid_body.kinematic", {1: True, 14: False})
