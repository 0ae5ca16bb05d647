# SPDX-License-Identifier: GPL-3.0-or-later
"""Milk runs out of a tilted jug into a bowl on a table."""

from ..props import box, revolved
from ..scene_setup import begin, camera, light
from ..simulation_parts import domain, effector, flow

BOWL = [(0, 0), (0.09, 0), (0.19, 0.1), (0.2, 0.12), (0.17, 0.12), (0.16, 0.1), (0.08, 0.025), (0, 0.025)]
JUG = [
    *((0, 0), (0.06, 0), (0.07, 0.1), (0.045, 0.2), (0.05, 0.22)),
    *((0.04, 0.22), (0.035, 0.2), (0.06, 0.1), (0.05, 0.01), (0, 0.01)),
]


def build():
    """Builds the scene."""
    begin(60)
    box("Kitchen table", (1.6, 1.0, 0.06), (0, 0, 0.71), colour=(0.5, 0.33, 0.17))
    effector(revolved("Bowl", BOWL, (0, 0, 0.74), colour=(0.45, 0.2, 0.1)), thickness=0.5)
    jug = revolved("Tin jug", JUG, (0.24, 0, 1.08), colour=(0.7, 0.7, 0.72), metal=1.0, roughness=0.3)
    jug.rotation_euler = (0, -1.9, 0)
    flow(
        box("Milk stream", (0.026, 0.026, 0.026), (0.02, 0, 1.0), colour=(0.95, 0.94, 0.9)),
        speed=(-0.1, 0, -0.2),
    )
    domain(box("Milk", (0.5, 0.5, 0.4), (0, 0, 0.9), colour=(0.95, 0.94, 0.9)), resolution=48)
    camera((0.9, -1.2, 1.35), (0.05, 0, 0.88), lens=40)
    light(sun=2.5, elevation=25, sky=(0.8, 0.75, 0.65))
