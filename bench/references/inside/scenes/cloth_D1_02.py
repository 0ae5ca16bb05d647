# SPDX-License-Identifier: GPL-3.0-or-later
"""A bedsheet falls from the rafters over a rocking chair, onto the armrests and down to the floorboards."""

from ..props import box, boxes, joined, legs, sheet, tube
from ..scene_setup import begin, camera, light
from ..simulation_parts import cloth, collider

OAK, BOARDS = (0.33, 0.2, 0.1), (0.5, 0.38, 0.25)
# From back to front: the runners touch the floor at their middle.
RUNNER = [(-0.5, 0.03 + 0.25 * 0.25), *((x / 10, 0.03 + x * x / 400) for x in range(-4, 6)), (0.55, 0.106)]


def build():
    """Builds the scene."""
    begin(84)
    collider(box("Floorboards", (6, 5, 0.1), (0, 0, -0.05), colour=BOARDS), friction=40)
    collider(_chair(), friction=30)
    box("Gable wall", (6.2, 0.1, 2.6), (0, 2.55, 1.3), colour=(0.6, 0.52, 0.42))
    beams = [((0.14, 5, 0.2), (x, 0, 2.5)) for x in (-1.4, 0, 1.4)]
    purlins = [((6, 0.16, 0.2), (0, y, 2.3)) for y in (2.42, -2.3)]
    posts = [((0.16, 0.16, 2.2), (x, -2.3, 1.1)) for x in (-2.9, 2.9)]
    boxes("Rafters", [*beams, *purlins, *posts], colour=BOARDS)
    linen = sheet(
        "Linen bedsheet", (2.7, 2.5), (54, 50), (0, 0, 1.75), turn=(0, 6, 20), colour=(0.9, 0.88, 0.84)
    )
    cloth(linen, mass=0.2, stiffness=10, quality=8, self_collision=True).settings.air_damping = 2  # billows
    camera((1.9, -4.3, 1.9), (0, 0, 1.0), lens=30)
    light(elevation=60, azimuth=-70, sky=(0.55, 0.5, 0.42))


def _chair():
    seat = [((0.55, 0.6, 0.06), (0, 0, 0.42)), ((0.08, 0.6, 0.7), (-0.25, 0, 0.75))]
    arms = [((0.6, 0.08, 0.05), (0.02, y, 0.66)) for y in (-0.3, 0.3)]
    posts = [((0.06, 0.06, 0.24), (0.24, y, 0.54)) for y in (-0.3, 0.3)]
    stand = [(size, (x, y, z + 0.05)) for size, (x, y, z) in legs(0.22, 0.27, 0.36)]
    chair = boxes("Chair", [*seat, *arms, *posts, *stand], colour=OAK)
    runners = [tube("Runner", [(x, y, z) for x, z in RUNNER], 0.03, colour=OAK) for y in (-0.27, 0.27)]
    return joined("Rocking chair", chair, *runners)
