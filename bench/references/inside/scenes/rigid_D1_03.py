# SPDX-License-Identifier: GPL-3.0-or-later
"""Five dice, thrown along a craps table, knock against its rail and come to rest."""

import math
import random

from mathutils import Euler, Vector

from ..props import box, boxes, cylinder, joined
from ..scene_setup import begin, camera, lamp, light
from ..simulation_parts import body, thrown

DIE, LONG, WIDE = 0.04, 1.5, 0.7
FELT = 0.75  # its height
CENTRE, FAR = (0, 0), 0.27  # of pips on a face, in sides of a die
CORNERS = [(i * FAR, j * FAR) for i in (-1, 1) for j in (-1, 1)]
ROWS = [(i * FAR, 0) for i in (-1, 1)]
PIPS = {
    1: [CENTRE],
    2: CORNERS[::3],
    3: [CENTRE, *CORNERS[::3]],
    4: CORNERS,
    5: [CENTRE, *CORNERS],
    6: CORNERS + ROWS,
}
FACES = {1: (0, 0), 6: (180, 0), 2: (90, 0), 5: (-90, 0), 3: (0, 90), 4: (0, -90)}  # turned around x, or y


def build():
    """Builds the scene."""
    begin(60)
    felt = box(
        "Green felt", (LONG, WIDE, 0.05), (0, 0, FELT - 0.025), colour=(0.02, 0.25, 0.1), roughness=1.0
    )
    body(felt, "PASSIVE", shape="BOX", friction=0.5, bounce=0.6)
    sides = [((0.08, WIDE + 0.16, 0.17), (i * (LONG + 0.08) / 2, 0, 0)) for i in (-1, 1)]
    sides += [((LONG, 0.08, 0.17), (0, j * (WIDE + 0.08) / 2, 0)) for j in (-1, 1)]
    rail = boxes("Leather rail", sides, (0, 0, FELT + 0.035), colour=(0.2, 0.07, 0.04), roughness=0.45)
    body(rail, "PASSIVE", shape="MESH", friction=0.4, bounce=0.9)
    chance = random.Random(7)
    for number in range(5):
        at = (-0.5 - 0.1 * (number % 2), 0.07 * (number - 2), FELT + 0.2 + 0.03 * (number % 3))
        die = _die(at, [chance.uniform(0, 360) for _ in range(3)])
        body(die, shape="BOX", mass=0.02, friction=0.4, bounce=0.7)
        spin = chance.uniform(-6, 6), chance.uniform(6, 12), chance.uniform(-6, 6)
        thrown(die, (1.8 + 0.15 * number, chance.uniform(-0.25, 0.25), 0.2), spin)
    camera((-0.15, -1.0, FELT + 1.2), (0.08, 0, FELT), lens=34)
    light(sun=0.4, sky=(0.12, 0.1, 0.1))
    lamp("Table lamp", 25, (0, 0, FELT + 1.1), colour=(1, 0.85, 0.6))


def _die(at, turn):
    """An ivory cube with thin dark discs for pips."""
    cube = box("Die", (DIE, DIE, DIE), colour=(0.9, 0.86, 0.72), roughness=0.3)
    pips = []
    for value, (x, y) in FACES.items():
        turned = Euler((math.radians(x), math.radians(y), 0)).to_matrix()
        for i, j in PIPS[value]:
            place = turned @ Vector((i, j, 0.5)) * DIE
            pips.append(
                cylinder("Pip", 0.1 * DIE, 0.0004, place, turn=(x, y, 0), sides=10, colour=(0.03, 0.03, 0.03))
            )
            pips[-1].data.materials[0] = pips[0].data.materials[0]
    die = joined("Die", cube, *pips)
    die.location, die.rotation_euler = at, [math.radians(angle) for angle in turn]
    return die
