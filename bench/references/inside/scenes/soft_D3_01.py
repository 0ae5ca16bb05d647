# SPDX-License-Identifier: GPL-3.0-or-later
"""A stone block falls on a jelly slab, which gives way and is squashed flat.

Rigid bodies do not feel soft ones. What the jelly does to the block is done by a plate that nobody sees, on a damped
spring as strong as the jelly should be; what the block does to the jelly is the soft body's own collision.
"""

from ..props import block, box, smooth
from ..scene_setup import begin, camera, light
from ..simulation_parts import body, collider, joint, limits, soft

SIDE, THICK = 0.7, 0.22
MASS = 60.0
SUNK = 0.15  # how far the spring gives under the block at rest
DAMPED = 1.3  # times what would just keep it from swinging


def build():
    """Builds the scene."""
    begin(60)
    board = box("Wooden board", (1.2, 1.0, 0.12), (0, 0, -0.06), colour=(0.5, 0.32, 0.16))
    body(board, "PASSIVE", shape="BOX")
    collider(board, thickness=0.012, inner=0.06)
    stone = box("Stone block", (0.6, 0.6, 0.3), (0, 0, 0.65), colour=(0.4, 0.4, 0.42), roughness=0.9)
    body(stone, shape="BOX", mass=MASS)
    collider(stone, thickness=0.012, inner=0.1)
    _hidden_spring(board)
    slab = block(
        "Jelly slab", (SIDE, SIDE, THICK), (10, 10, 5), (0, 0, THICK / 2 + 0.008), colour=(0.1, 0.6, 0.12)
    )
    for point in slab.data.vertices:  # bulging sides buckle outwards
        point.co.xy *= 1.08 - 0.08 * (2 * point.co.z / THICK) ** 2
    # Light and weak: the collision's push, which is what it is, is then strong beside springs and weight.
    soft(smooth(slab), mass=0.1, stiffness=0.35, bending=0.3)
    camera((1.4, -1.9, 1.0), (0, 0, 0.3), lens=36)
    light()


def _hidden_spring(board):
    plate = box("Hidden plate", (0.5, 0.5, 0.02), (0, 0, THICK + 0.03))
    plate.hide_render = True
    body(plate, shape="BOX", mass=1.0)
    tie = joint("Hidden spring", "GENERIC_SPRING", plate, board, plate.location)
    still = ("lin_x", "lin_y", "ang_x", "ang_y", "ang_z")
    limits(tie, **dict.fromkeys(still, (0, 0)))
    tie.use_spring_z, tie.spring_stiffness_z = True, MASS * 9.81 / SUNK
    tie.spring_damping_z = DAMPED * 2 * (MASS * tie.spring_stiffness_z) ** 0.5
