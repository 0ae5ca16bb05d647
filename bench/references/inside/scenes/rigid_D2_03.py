# SPDX-License-Identifier: GPL-3.0-or-later
"""An iron weight on a chain swings from a crane into a wall of twelve bricks, and breaks the mortar that holds them."""

import math

from mathutils import Matrix, Vector

from ..props import ball, box, boxes, joined, revolved
from ..scene_setup import begin, camera, light, under
from ..simulation_parts import body, joint

LONG, DEEP, HIGH = 0.4, 0.2, 0.18  # of a brick
ROWS, ACROSS = 4, 3
HOOK = Vector((0, 0, 3.0))
RADIUS = 0.22
HANGS = 2.65  # from the hook to the middle of the weight
DRAWN_BACK = math.radians(55)
STRONG = 5.0  # the impulse at which a joint of mortar breaks, Ns


def build():
    """Builds the scene."""
    begin(72)
    ground = box("Asphalt", (14, 10, 0.2), (2, 0, -0.1), colour=(0.12, 0.12, 0.13), roughness=0.95)
    body(ground, "PASSIVE", shape="BOX", friction=0.9)
    _swing()
    _wall(0.35)
    camera((2.6, -4.9, 2.3), (0.1, 0.3, 1.45), lens=26)
    light(sun=2.5, azimuth=20, sky=(0.55, 0.57, 0.6))


def _wall(x):
    """Courses that are shifted by half a brick; each brick is glued to those that it touches.

    Mortar that is broken keeps what it says of collisions: the bricks must collide from the beginning.
    """
    bricks = {}
    for row in range(ROWS):
        for place in range(ACROSS):
            y = (place - (ACROSS - 1) / 2 + (0.25 if row % 2 else -0.25)) * LONG
            at = Vector((x + DEEP / 2, y, (row + 0.5) * HIGH))
            brick = box("Brick", (DEEP, LONG, HIGH), at, colour=(0.5 + 0.05 * (place % 2), 0.2, 0.13))
            body(brick, shape="BOX", mass=12, friction=0.8)
            bricks[row, place] = brick
    for (row, place), brick in bricks.items():
        neighbours = [(row, place + 1), (row + 1, place), (row + 1, place + (-1 if row % 2 == 0 else 1))]
        for other in filter(None, map(bricks.get, neighbours)):
            mortar = joint(
                "Mortar", "FIXED", brick, other, (brick.location + other.location) / 2, collide=True
            )
            mortar.use_breaking, mortar.breaking_threshold = True, STRONG


def _swing():
    """The weight hangs from the crane's hook as from a rigid rod, which is its chain."""
    arms = [
        ((0.3, 0.3, 3.6), (0, 2.2, 1.8)),
        ((0.24, 2.6, 0.24), (0, 1, 3.48)),
        ((0.06, 0.06, 0.4), (0, 0, 3.2)),
    ]
    crane = boxes("Crane", arms, colour=(0.75, 0.55, 0.05))
    body(crane, "PASSIVE", shape="MESH")
    weight = ball("Iron weight", RADIUS, HOOK - Vector((0, 0, HANGS)), colour=(0.1, 0.1, 0.11), metal=0.8)
    under(weight, _chain(HANGS - RADIUS))
    turn = Matrix.Rotation(DRAWN_BACK, 3, "Y")
    weight.location, weight.rotation_euler = HOOK + turn @ (weight.location - HOOK), turn.to_euler()
    body(weight, shape="SPHERE", mass=400)
    joint("Hook", "POINT", crane, weight, HOOK)


def _chain(length):
    """Links from the hook downwards, each turned against the one before."""
    ring = [
        (0.05 + 0.014 * math.cos(t), 0.014 * math.sin(t)) for t in (math.tau * step / 8 for step in range(9))
    ]
    count = round(length / 0.105)
    links = []
    for number in range(count + 1):
        link = revolved(
            "Link", ring, (0, 0, HOOK.z - number * length / count), sides=12, colour=(0.2, 0.2, 0.21)
        )
        upright = Matrix.Rotation(math.pi / 2 * (number % 2), 4, "Z") @ Matrix.Rotation(math.pi / 2, 4, "X")
        link.data.transform(Matrix.Diagonal((1, 1, 1.35, 1)) @ upright)
        links.append(link)
    return joined("Chain", *links)
