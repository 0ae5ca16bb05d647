# SPDX-License-Identifier: GPL-3.0-or-later
"""A blancmange slips out of its mould onto a plate, sags, wobbles and comes to rest."""

from ..props import boxes, legs, revolved
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import collider, soft
from ..soft_body_struts import braced

PLATE = [(0, 0), (0.12, 0), (0.2, 0.02), (0.2, 0.026), (0.12, 0.012), (0, 0.012)]
SIDE = [
    (0.112, 0.01),
    (0.107, 0.035),
    (0.1, 0.06),
    (0.092, 0.075),
    (0.088, 0.1),
    (0.078, 0.13),
    (0.05, 0.145),
]
SHELL = 0.006


def build():
    """Builds the scene."""
    begin(72)
    boxes("Tea table", [*legs(0.55, 0.35, 0.68), ((1.2, 0.8, 0.04), (0, 0, 0.7))], colour=(0.4, 0.24, 0.12))
    plate = revolved("China plate", PLATE, (0, 0, 0.72), colour=(0.9, 0.9, 0.88), roughness=0.2)
    collider(plate, thickness=0.004, inner=0.006, damping=0.2)
    profile = [(0, 0), (0.07, 0), (0.1, 0), *SIDE, (0.025, 0.15), (0, 0.15)]
    pudding = revolved("Pink blancmange", profile, (0, 0, 0.79), sides=24, colour=(0.9, 0.45, 0.5))
    inner = [(radius + 0.001, height) for radius, height in SIDE]
    outer = [(radius + SHELL, height) for radius, height in SIDE[::-1]]
    shell = [(0, 0.15 + SHELL), *outer, *inner, (0, 0.151)]
    mould = revolved("Copper mould", shell, (0, 0, 0.79), colour=(0.7, 0.35, 0.2), metal=1.0, roughness=0.3)
    # Aslant, it lands on its edge: that makes it sway.
    pudding.rotation_euler = mould.rotation_euler = (0, 0.25, 0)
    soft(braced(pudding), stiffness=0.045, bending=0, damping=0).settings.friction = 0.2
    # A hand lifts the mould off, and puts it down beside.
    keys(mould, "location", {1: mould.location.copy(), 14: (-0.16, 0, 1.0), 34: (-0.36, 0.06, 0.71)})
    keys(mould, "rotation_euler", {14: mould.rotation_euler.copy(), 34: (0, 0, 0)})
    camera((0.25, -1.05, 1.2), (-0.08, 0, 0.83), lens=40)
    light(sky=(0.7, 0.65, 0.6))
